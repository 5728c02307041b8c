"""Layout and projection of a record: from a place in the plot to a ping and a range bin, and back."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QRect

from insonify.arrays import Floats, Integers, Singles
from insonify.display.display_options import DisplayOptions, side_factors
from insonify.display.picture import average_columns, place_columns
from insonify.display.range_axis import SLANT, RangeAxis, choose_kind, make_range_axis
from insonify_viewer.record.record import Record
from insonify_viewer.state.inspection import Mark

BEYOND = np.float32(-1.0)  # amplitude of columns that lie beyond the last bin
CLOSEST = 1.0 / 64.0  # least share of the record that a zoom shows
STEPS = 50.0  # of altitude over the range, by which the reach of a picture changes
ALIKE = 0.02  # deviation of two scales that counts as none
MANY = 10.0  # ratio that is written in whole numbers


class Zoom(NamedTuple):
    """Part of the whole picture that is shown, in shares of it, from its left and upper edges."""

    left: float = 0.0
    right: float = 1.0
    upper: float = 0.0
    lower: float = 1.0

    @property
    def whole(self) -> bool:
        """Whether the whole picture is shown."""
        return self == Zoom()

    def about(self, u: float, v: float, factor: float) -> Zoom:
        """Magnify by a factor; the point at the shares u and v of the plot stays where it is."""
        across = _scaled((self.left, self.right), u, factor)
        return Zoom(*across, *_scaled((self.upper, self.lower), v, factor))

    def moved(self, u: float, v: float) -> Zoom:
        """Move the part by shares of the plot, as far as the picture goes."""
        across = _moved((self.left, self.right), u * (self.right - self.left))
        return Zoom(*across, *_moved((self.upper, self.lower), v * (self.lower - self.upper)))


@dataclass(frozen=True, eq=False)
class Projection:
    """Bins of a record in a plot, whose places are shares from its left and upper edges."""

    axis: RangeAxis  # distance across the plot
    side: str  # ``both``, ``port`` or ``starboard``
    newest_on_top: bool  # whether later pings stand above earlier ones
    zoom: Zoom  # part that is shown
    newest: int  # number of the newest ping of the picture
    pings: int  # pings from the upper to the lower edge of the whole picture
    # Altitudes of pings, (n,) int64 to (n,) float64, in metres; 0 where they are not known.
    altitude_of: Callable[[Integers], Floats]
    # (2 bins,) factors on the amplitudes of a row, from far port to far starboard.
    factors: Singles | None = None

    @property
    def extent(self) -> tuple[float, float]:
        """Distances at the left and right edges of the whole picture, in metres, negative to port."""
        reach = self.axis.reach
        return (0.0 if self.side == "starboard" else -reach), (0.0 if self.side == "port" else reach)

    @property
    def shown(self) -> tuple[float, float]:
        """Distances at the left and right edges of the plot, in metres, negative to port."""
        first, last = self.extent
        return first + self.zoom.left * (last - first), first + self.zoom.right * (last - first)

    @property
    def ages(self) -> tuple[float, float]:
        """Pings since the newest at the upper and lower edges of the plot."""
        upper, lower = self.zoom.upper * self.pings, self.zoom.lower * self.pings
        return (upper, lower) if self.newest_on_top else (self.pings - upper, self.pings - lower)

    def across(self, distance: Floats) -> Floats:
        """Shares of the plot's width at which distances lie, negative ones to port."""
        first, last = self.shown
        return np.asarray((distance - first) / (last - first))

    def down(self, ping: Floats) -> Floats:
        """Shares of the plot's height at which pings lie; whole numbers stand for the upper edges of newest on top."""
        upper, lower = self.ages
        return np.asarray((self.newest - ping - upper) / (lower - upper))

    def mark_at(self, u: float, v: float) -> Mark | None:
        """Find the bin at a place of the plot; None before the first ping and beyond the last bin."""
        if not (0.0 <= u < 1.0 and 0.0 <= v < 1.0):
            return None
        upper, lower = self.ages
        age = upper + v * (lower - upper)
        ping = self.newest - (math.floor(age) if self.newest_on_top else math.ceil(age) - 1)
        if not 0 <= self.newest - ping < self.pings or ping < 0:
            return None
        first, last = self.shown
        distance = first + u * (last - first)
        side = int(distance >= 0.0 and self.side != "port")
        position = self.axis.bins_at(np.array([abs(distance)]), self._altitude(ping))[0]
        # The last place before the edge of the plot may round to the edge itself.
        return Mark(ping, side, int(position)) if position < self.axis.bins else None

    def place_of(self, mark: Mark, *, beside: float = 0.5) -> tuple[float, float]:
        """Place of a bin, at a share of its width; outside the plot where the picture leaves it out."""
        u, v = self.places_of(np.array([[mark.ping, mark.side, mark.bin]]), beside=beside)[0].tolist()
        return u, v

    def places_of(self, marks: Integers, *, beside: float = 0.5) -> Floats:
        """Places, (n, 2), of bins, (n, 3) ping, side and bin, as `place_of` gives those of one."""
        ping, side, bins = marks.T
        distance = self.axis.distance_of(bins + beside, self.altitude_of(ping))
        left_out = np.isnan(distance)
        if self.side != "both":
            left_out |= side != (self.side == "starboard")
        places = np.stack([self.across(np.where(side == 1, distance, -distance)), self.down(ping - 0.5)], axis=1)
        return np.asarray(np.where(left_out[:, None], -1.0, places))

    def columns(self, amplitude: Singles, altitude: Floats, width: int, rows: Integers | None = None) -> Singles:
        """Average bins into the columns of the plot, or repeat them where there are more columns than bins."""
        edges, nadir = self._edges(width)
        out = np.empty((len(altitude), width), dtype=np.float32)
        bins = self.axis.bins
        port, starboard = range(bins - 1, -1, -1), range(bins, 2 * bins)
        if nadir > 0:
            out[:, :nadir] = self._side(amplitude, port, -edges[nadir::-1], altitude, rows)[:, ::-1]
        if nadir < width:
            out[:, nadir:] = self._side(amplitude, starboard, edges[nadir:], altitude, rows)
        return out

    def bins_of_columns(self, ping: int, width: int) -> Integers:
        """Range bin in the middle of every column in a ping, (width,); the last one beyond it."""
        edges, _ = self._edges(width)
        middle = np.abs(0.5 * (edges[1:] + edges[:-1]))
        return np.minimum(self.axis.bins_at(middle, self._altitude(ping)), self.axis.bins - 1).astype(np.int64)

    def loudest(self, row: Singles, ping: int, width: int) -> Singles:
        """Loudest bin of every column of the plot in a ping, from its row from far port to far starboard; 0 beyond."""
        edges, nadir = self._edges(width)
        at, bins = self.axis.bins_at(np.abs(edges), self._altitude(ping)), self.axis.bins
        out = np.zeros(width, dtype=np.float32)
        if nadir > 0:
            out[:nadir] = _loudest(row[bins - 1 :: -1], at[nadir::-1])[::-1]
        if nadir < width:
            out[nadir:] = _loudest(row[bins:], at[nadir:])
        return out

    def _altitude(self, ping: int) -> Floats:
        return self.altitude_of(np.array([ping], dtype=np.int64))

    def _edges(self, width: int) -> tuple[Floats, int]:
        """Distances at the edges of the columns, one of them exactly at nadir if it is shown, and which one."""
        edges = np.linspace(*self.shown, width + 1)
        if self.side != "both" or edges[0] >= 0.0 or edges[-1] <= 0.0:
            return edges, 0 if self.side == "starboard" or edges[0] >= 0.0 else width
        nadir = int(np.argmin(np.abs(edges)))
        edges[nadir] = 0.0
        return edges, nadir

    def _side(
        self, amplitude: Singles, bins: range, distance: Floats, altitude: Floats, rows: Integers | None
    ) -> Singles:
        position = place_columns(np.maximum(distance, 0.0), altitude, self.axis)
        found = average_columns(amplitude, position, picked=rows, bins=bins)
        if not self.axis.shows_water:
            found[position[:, :-1] >= self.axis.bins] = BEYOND
        return found


def _loudest(values: Singles, at: Floats) -> Singles:
    """Greatest of the values that lie, if only in part, between successive positions; 0 beyond the last value."""
    first = np.minimum(at[:-1].astype(np.int64), values.size)
    end = np.maximum(np.minimum(np.ceil(at[1:]).astype(np.int64), values.size), np.minimum(first + 1, values.size))
    ends = np.stack([first, end], axis=1).ravel()
    return np.asarray(np.maximum.reduceat(np.append(values, np.float32(0.0)), ends)[::2])


def _scaled(span: tuple[float, float], at: float, factor: float) -> tuple[float, float]:
    first, last = span
    length = max((last - first) / factor, CLOSEST)
    if length > 1.0 - 1e-9:  # by rounding, a part that was moved may be as long as the whole but for its last digits
        return 0.0, 1.0
    start = first + at * (last - first) - at * length
    start = min(max(start, 0.0), 1.0 - length)
    return start, start + length


def _moved(span: tuple[float, float], by: float) -> tuple[float, float]:
    first, last = span
    by = min(max(by, -first), 1.0 - last)
    return first + by, last + by


def choose_axis(look: DisplayOptions, record: Record, slant_range: float) -> RangeAxis:
    """Distance across the picture of a record; slant range where its bed is not known or out of range."""
    bin_length = slant_range / record.bins
    lowest = record.lowest
    lowest = math.floor(STEPS * lowest / slant_range) * slant_range / STEPS if math.isfinite(lowest) else lowest
    kind = choose_kind(ground_range=look.ground_range, water_column=look.water_column)
    axis = make_range_axis(kind, record.bins, bin_length, lowest)
    return axis or RangeAxis(SLANT, record.bins, bin_length, slant_range)


def row_factors(look: DisplayOptions, bins: int) -> Singles | None:
    """Factors on a row of a record, from far port to far starboard; None where there are none."""
    factors = side_factors(look, bins)
    return None if factors is None else np.concatenate([factors[0, ::-1], factors[1]])


def project_record(look: DisplayOptions, record: Record, axis: RangeAxis, zoom: Zoom, newest: int) -> Projection:
    """Projection of a record, given its newest ping on screen."""
    factors = row_factors(look, record.bins)
    return Projection(axis, look.side, look.newest_on_top, zoom, newest, record.pings, record.altitude_of, factors)


def zoom_to_true_scale(zoom: Zoom, room: tuple[int, int], across: float, along: float, *, newest_on_top: bool) -> Zoom:
    """Show as much of the track as fills the room at true scale, from the newest ping of the zoom on."""
    width = min(zoom.right - zoom.left, along / across * room[0] / room[1])  # less of the range on a short track
    left = min(max(0.5 * (zoom.left + zoom.right - width), 0.0), 1.0 - width)
    zoom = zoom._replace(left=left, right=left + width)
    share = min(width * across / room[0] * room[1] / along, 1.0)
    if newest_on_top:
        upper = min(zoom.upper, 1.0 - share)
        return zoom._replace(upper=upper, lower=upper + share)
    lower = max(zoom.lower, share)
    return zoom._replace(upper=lower - share, lower=lower)


def name_scale(plot: QRect, along: float, across: float) -> str:
    """State whether a plot is at true scale, and by how much the track is drawn out or compressed else."""
    ratio = (plot.height() / along) / max(plot.width() / across, 1e-9)
    if abs(ratio - 1.0) < ALIKE:
        return "1 : 1"
    sign, by = ("×", ratio) if ratio > 1.0 else ("÷", 1.0 / ratio)
    return f"track {sign} {by:.2g}" if by < MANY else f"track {sign} {by:.0f}"
