"""Occlusion of the bed by targets, in the launch angles of one plane.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_before_typing, inlined_uncounted
from insonify.kernels.common.search import last_not_above
from insonify.kernels.geometry.cross_sections import DOWN, NEVER, UP
from insonify.kernels.targets.angular_zbuffer import EDGE, cell_towards


@inlined_uncounted
def occluded_slopes(zbuffer, cells):
    """Launch slopes between which any target may hide the bed."""
    if cells <= 0:
        return NEVER, -NEVER
    low, high = zbuffer.edge[0], zbuffer.edge[cells]
    # The outermost cells of a body end a hair inside it.
    return (
        math.tan(low) * (1.0 + math.copysign(EDGE, -low)) if low > DOWN else -NEVER,
        math.tan(high) * (1.0 + math.copysign(EDGE, high)) if high < UP else NEVER,
    )


class Occlusion(NamedTuple):
    """Cells of a z-buffer as the bed behind them needs them."""

    edge: NDArray[np.float64]  # (cells + 1,), empty without cells
    cosine: NDArray[np.float64]  # of the edges
    sine: NDArray[np.float64]
    nearness_cosine: NDArray[np.float64]
    nearness_sine: NDArray[np.float64]


@inlined_before_typing
def occlusion_of(zbuffer, cells):
    """Cells of a z-buffer that hide the bed."""
    n = cells + 1 if cells > 0 else 0
    nearness_cosine, nearness_sine = zbuffer.nearness_cosine[:n], zbuffer.nearness_sine[:n]
    return Occlusion(zbuffer.edge[:n], zbuffer.cosine[:n], zbuffer.sine[:n], nearness_cosine, nearness_sine)


@inlined_uncounted
def is_hidden(occlusion, segment, x_from, x_to):
    """Whether targets hide all of a segment of the bed between two ground ranges, by a test without angles."""
    first, end = hiding_cells(occlusion, segment, x_from, x_to)
    return first < end


@inlined_uncounted
def hiding_cells(occlusion, segment, x_from, x_to):
    """Range (start, stop) of the cells behind which a segment is hidden between two ground ranges, else (0, 0)."""
    cells = occlusion.edge.size - 1
    z_from, z_to = segment.offset + segment.slope * x_from, segment.offset + segment.slope * x_to
    first = cell_towards(occlusion.cosine, occlusion.sine, cells, x_from, z_from)
    last = cell_towards(occlusion.cosine, occlusion.sine, cells, x_to, z_to)
    if first < 0 or last < 0:
        return 0, 0
    first, last = min(first, last), max(first, last)
    # The target's nearness times the distance is linear along the segment, and above 1 where the target is nearer.
    for cell in range(first, last + 1):
        level, rise = occlusion.nearness_cosine[cell], occlusion.nearness_sine[cell]
        if level * x_from + rise * z_from <= 1.0 or level * x_to + rise * z_to <= 1.0:
            return 0, 0
    return first, last + 1


@inlined_uncounted
def next_visible(occlusion, segment, start, stop):
    """First stretch of launch angles in which targets leave a segment of the bed visible."""
    edge, nearness_cosine, nearness_sine = occlusion.edge, occlusion.nearness_cosine, occlusion.nearness_sine
    cell = last_not_above(edge, start)
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
    """Part of a stretch of launch angles within one cell in which the bed is nearer than the target there."""
    if cell < 0 or cell >= edge.size - 1:
        return start, end
    # The bed's own nearness is (sin θ − slope · cos θ) / offset, and offset < 0 where it is in sight:
    # docs/theory/sweep.md
    constant, rate = nearness_cosine[cell] * segment.offset + segment.slope, nearness_sine[cell] * segment.offset - 1.0
    if rate == 0.0:
        return (start, end) if constant >= 0.0 else (end, end)
    border = math.atan(-constant / rate)
    return (max(start, border), end) if rate > 0.0 else (start, min(end, border))
