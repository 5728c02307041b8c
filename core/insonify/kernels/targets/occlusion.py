"""What targets hide of the bed behind them, as one plane shows it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.jit import inlined, inlined_uncounted
from insonify.kernels.geometry.cross_sections import DOWN, NEVER, UP
from insonify.kernels.targets.angular_zbuffer import EDGE


@inlined_uncounted
def occluded_slopes(zbuffer, cells):
    """Slopes between which any body may hide the bed."""
    if cells <= 0:
        return NEVER, -NEVER
    low, high = zbuffer.edge[0], zbuffer.edge[cells]
    # The outermost cells of a body end a hair inside it.
    return (
        math.tan(low) * (1.0 + math.copysign(EDGE, -low)) if low > DOWN else -NEVER,
        math.tan(high) * (1.0 + math.copysign(EDGE, high)) if high < UP else NEVER,
    )


class Occlusion(NamedTuple):
    """What of a screen the bed behind it needs to know."""

    edge: NDArray[np.float64]  # (cells + 1,), empty without cells
    nearness_cosine: NDArray[np.float64]
    nearness_sine: NDArray[np.float64]


@inlined
def occlusion_of(zbuffer, cells):
    """Return what hides the bed; without cells, nothing does."""
    n = cells + 1 if cells > 0 else 0
    return Occlusion(zbuffer.edge[:n], zbuffer.nearness_cosine[:n], zbuffer.nearness_sine[:n])


@inlined_uncounted
def next_visible(occlusion, segment, start, stop):
    """Return the first stretch of launch angles in [start, stop] in which a segment of the bed is not hidden."""
    edge, nearness_cosine, nearness_sine = occlusion.edge, occlusion.nearness_cosine, occlusion.nearness_sine
    cell = np.searchsorted(edge, start, side="right") - 1
    opened, closed = stop, stop
    while start < stop:
        end = min(edge[cell + 1], stop) if cell + 1 < edge.size else stop
        low, high = _visible_part(edge, nearness_cosine, nearness_sine, cell, segment, start, end)
        if opened < stop and not low == start < high:
            break
        if low < high:
            opened, closed = min(opened, low), high
            if high < end:
                break
        start, cell = end, cell + 1
    return opened, closed


@inlined_uncounted
def _visible_part(edge, nearness_cosine, nearness_sine, cell, segment, start, end):
    """Part of a stretch of launch angles within one cell in which the bed is nearer than what is nearest there."""
    if cell < 0 or cell >= edge.size - 1:
        return start, end
    # The bed's own nearness is (sin θ − slope · cos θ) / offset, and offset < 0 where it is in sight.
    constant, rate = nearness_cosine[cell] * segment.offset + segment.slope, nearness_sine[cell] * segment.offset - 1.0
    if rate == 0.0:
        return (start, end) if constant >= 0.0 else (end, end)
    border = math.atan(-constant / rate)
    return (max(start, border), end) if rate > 0.0 else (start, min(end, border))
