"""One sentence on what a pixel shows, or why it is dark."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from insonify.explanation.contributions import Contribution
from insonify.explanation.obstructions import Obstruction
from insonify.explanation.pixel_parts import PixelParts
from insonify.explanation.pixel_window import whole_window
from insonify.tracers.azimuth_fan import lay_planes_of_images
from insonify.tracers.echo_parts import HEARD, EchoParts, find_direct_parts, take_central_plane

SHADOW = 0.5  # share of the echo that is hidden from which a pixel counts as shadow
SPREAD = 0.95  # share of the echo of the first contributor up to which others are told of


def summarise_pixel(
    pixel: PixelParts, contributions: Sequence[Contribution], obstructions: Sequence[Obstruction]
) -> str:
    """Say what a pixel shows, or why it is dark."""
    hiding = sum(each.share for each in obstructions)
    if obstructions and (hiding >= SHADOW or not contributions):
        return _shadow(obstructions[0], bool(contributions))
    if not contributions:
        return _silence(pixel)
    first = contributions[0]
    told = f"{first.words} at {first.ground_range:.1f} m, incidence {first.incidence:.0f}°"
    if first.share < SPREAD:
        told = f"{100 * first.share:.0f} % {told}; then {contributions[1].words}"
    return told


def _shadow(greatest: Obstruction, heard: bool) -> str:
    """Say what hides the bed there."""
    if greatest.faces_away:
        return f"no echo: the slope behind the crest at {greatest.ground_range:.1f} m faces away from the sonar"
    mostly = "mostly in the shadow" if heard else "in the shadow"
    if greatest.target >= 0:
        return f"{mostly} of {greatest.hider}, which hides the bed at {greatest.ground_range:.1f} m"
    return f"{mostly} of a crest of the bed at {greatest.ground_range:.1f} m"


def _silence(pixel: PixelParts) -> str:
    """Say why nothing returns an echo although nothing is hidden."""
    if pixel.folded:
        return "no echo: no ray lands there"
    heard = athwart_parts(pixel)
    first = float(heard.near.min(initial=math.inf))
    if pixel.window.far <= first:
        return f"water column: the first echo comes from {first:.1f} m" if math.isfinite(first) else "no bed in range"
    if pixel.parts.value.size == 0:
        return "no echo: no bed there"
    return "no echo: outside the beam" if not np.any(pixel.parts.weight > 0.0) else "no echo: the slope faces away"


def athwart_parts(pixel: PixelParts) -> EchoParts:
    """Parts that are heard in all bins, in the plane along the axis of the beam."""
    fans = lay_planes_of_images(pixel.arrays, pixel.pose, 1)
    if not fans:
        return pixel.parts.take(np.zeros(0, np.int64))
    fan = take_central_plane(pixel.arrays, fans[0][1])
    window = whole_window(pixel.arrays).window
    parts = find_direct_parts(pixel.arrays, pixel.pose, pixel.side, window, fan)
    return parts.take(parts.state == HEARD)
