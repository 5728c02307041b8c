"""Makes the projection of a record for the room that there is."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.display.display_options import DisplayOptions, side_factors
from insonify.display.range_axis import SLANT, RangeAxis, choose_kind, make_range_axis
from insonify_viewer.record.projection import Projection, Zoom
from insonify_viewer.record.record import Record

STEPS = 50.0  # of altitude over the range, by which the reach of a picture changes


def choose_axis(look: DisplayOptions, record: Record, slant_range: float) -> RangeAxis:
    """Distance across the picture of a record; slant range where its bed is not known or out of range."""
    bin_length = slant_range / record.bins
    lowest = record.lowest
    lowest = math.floor(STEPS * lowest / slant_range) * slant_range / STEPS if math.isfinite(lowest) else lowest
    kind = choose_kind(ground_range=look.ground_range, water_column=look.water_column)
    axis = make_range_axis(kind, record.bins, bin_length, lowest)
    return axis or RangeAxis(SLANT, record.bins, bin_length, slant_range)


def row_factors(look: DisplayOptions, bins: int) -> NDArray[np.float32] | None:
    """Factors on a row of a record, from far port to far starboard; None where there are none."""
    factors = side_factors(look, bins)
    return None if factors is None else np.concatenate([factors[0, ::-1], factors[1]])


def project_record(look: DisplayOptions, record: Record, axis: RangeAxis, zoom: Zoom, newest: int) -> Projection:
    """Projection of a record whose newest ping on screen is given."""
    factors = row_factors(look, record.bins)
    return Projection(axis, look.side, look.newest_on_top, zoom, newest, record.pings, record.altitude_of, factors)


def zoom_to_true_scale(zoom: Zoom, room: tuple[int, int], across: float, along: float, *, newest_on_top: bool) -> Zoom:
    """Show as much of the track as fills the room at true scale, from the newest ping of the zoom on."""
    metres = (zoom.right - zoom.left) * across / room[0] * room[1]
    share = min(metres / along, 1.0)
    if newest_on_top:
        upper = min(zoom.upper, 1.0 - share)
        return zoom._replace(upper=upper, lower=upper + share)
    lower = max(zoom.lower, share)
    return zoom._replace(upper=lower - share, lower=lower)
