"""Stretches of one segment of the bed by what hides them: nothing, bed before it or a target.

The record needs what is visible alone (`deposit_visible_stretches`); labels and the parts of an echo need all of it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, inlined_uncounted
from insonify.kernels.common.search import last_not_above
from insonify.kernels.labels.shadows import NO_TARGET
from insonify.kernels.sweep.partial_segments import ground_range_at, launch_angle, next_stretch
from insonify.kernels.sweep.target_echoes import target_of_body
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, AngularZbuffer
from insonify.kernels.targets.occlusion import hiding_cells

VISIBLE, BEHIND_BED, BEHIND_TARGET = 0, 1, 2
EACH_CELL = 3  # stretches of a segment that one cell of a z-buffer may make


class Stretches(NamedTuple):
    """Stretches of one segment of the bed, one entry each, in the order of their ground ranges."""

    x_from: NDArray[np.float64]  # ground range of the ends, m
    x_to: NDArray[np.float64]
    state: NDArray[np.int64]  # VISIBLE, BEHIND_BED or BEHIND_TARGET
    hider: NDArray[np.int64]  # index of the declared target that hides it, NO_TARGET where none does


@inlined
def empty_stretches(zbuffer: AngularZbuffer) -> Stretches:
    """Make room for the stretches of any segment."""
    room = EACH_CELL * (zbuffer.edge.size + 1)
    return Stretches(np.empty(room), np.empty(room), np.empty(room, np.int64), np.empty(room, np.int64))


@inlined_uncounted
def split_segment(segment, x_from, x_to, risen, occlusion, arrays, zbuffer, stretches):
    """Split a segment that rises above the horizon at the ground range ``risen``; return the number of stretches."""
    n = _add_stretch(stretches, 0, x_from, risen, BEHIND_BED, NO_TARGET)
    if occlusion.edge.size == 0:
        return _add_stretch(stretches, n, risen, x_to, VISIBLE, NO_TARGET)
    hider = _only_hider(segment, risen, x_to, occlusion, arrays, zbuffer)
    if hider != NO_TARGET:
        return _add_stretch(stretches, n, risen, x_to, BEHIND_TARGET, hider)
    x, low, high = risen, launch_angle(segment, risen), launch_angle(segment, x_to)
    while low < high:
        opened, closed, start, stop = next_stretch(occlusion, segment, low, high, x, x_to)
        if opened > low:
            n = _split_hidden(segment, low, opened, x, start, occlusion.edge, arrays, zbuffer, stretches, n)
        if opened >= high:
            break
        n = _add_stretch(stretches, n, start, stop, VISIBLE, NO_TARGET)
        low, x = closed, stop
    return n


@inlined_uncounted
def _only_hider(segment, x_from, x_to, occlusion, arrays, zbuffer):
    """Target that hides all of a segment between two ground ranges, if one alone does."""
    first, end = hiding_cells(occlusion, segment, x_from, x_to)
    hider = NO_TARGET
    for cell in range(first, end):
        own = target_of_body(arrays.solids, arrays.mesh, zbuffer.body[zbuffer.nearest[cell]])
        if hider != NO_TARGET and own != hider:
            return NO_TARGET
        hider = own
    return hider


@inlined_uncounted
def _split_hidden(segment, low, high, x_from, x_to, edge, arrays, zbuffer, stretches, n):
    """Split a stretch that targets hide between two launch angles, by the target that is nearest in each cell."""
    cell, hider = max(last_not_above(edge, low), 0), NO_TARGET
    while low < high and cell + 1 < edge.size:
        p, own = zbuffer.nearest[cell], NO_TARGET
        if p != NO_PRIMITIVE:
            own = target_of_body(arrays.solids, arrays.mesh, zbuffer.body[p])
        if own != hider:
            start = min(max(ground_range_at(segment, low), x_from), x_to)
            n, x_from, hider = _add_hidden(stretches, n, x_from, start, hider), start, own
        low, cell = edge[cell + 1], cell + 1
    stop = x_to if low >= high else min(max(ground_range_at(segment, low), x_from), x_to)
    return _add_hidden(stretches, n, x_from, stop, hider)


@inlined_uncounted
def _add_hidden(stretches, n, x_from, x_to, hider):
    """Append a stretch that a target hides, if one does; return the number of stretches."""
    return n if hider == NO_TARGET else _add_stretch(stretches, n, x_from, x_to, BEHIND_TARGET, hider)


@inlined_uncounted
def _add_stretch(stretches, n, x_from, x_to, state, hider):
    """Append a stretch; return the number of stretches."""
    stretches.x_from[n], stretches.x_to[n], stretches.state[n], stretches.hider[n] = x_from, x_to, state, hider
    return n + 1
