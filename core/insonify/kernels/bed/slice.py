"""Profile of a gridded bed along a vertical half-plane through the sonar, at any azimuth.

Knots lie where the plane crosses *both* families of grid lines, so that every segment belongs to one cell.
Near the grid's axes the grid is walked in strips between neighbouring lines of the sparser family; within a strip the
knots lie on consecutive nodes of two rows of memory. Oblique planes are walked line by line. Derived in
docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.bed.grid import MERGED, clip_to_grid, first_line, is_oblique, wrap_index
from insonify.kernels.bed.oblique_walk import walk_oblique
from insonify.kernels.bed.profile import padded_count
from insonify.kernels.bed.subdivision import measure_segments


class GridWalk(NamedTuple):
    """Path of a plane over the grid: u counts strips, v runs along the axis of the lines that it crosses most often."""

    nodes: NDArray[np.float32]  # heights, [u, v]
    v_is_y: bool
    u0: float  # the sonar's place, in nodes
    v0: float
    z0: float  # and its height, m
    eu: float  # the plane's azimuth
    ev: float


@inlined_uncounted
def slice_bed(bed, limits, x, y, z, ex, ey, reach, profile):
    """Cut the bed with a vertical half-plane."""
    u0, v0 = (x - bed.x0) / bed.spacing, (y - bed.y0) / bed.spacing
    v_is_y = abs(ey) >= abs(ex)
    nodes = bed.transposed if v_is_y else bed.heights
    if not v_is_y:
        u0, v0, ex, ey = v0, u0, ey, ex
    # A profile serves one bed: if the first segment already has the only material, all segments have it.
    if not bed.mapped and profile.material[0] != bed.materials[0, 0]:
        profile.material[:] = bed.materials[0, 0]
    near, far = 0.0, reach
    if not bed.periodic:
        near, far = clip_to_grid(u0, ex / bed.spacing, nodes.shape[0] - 1.0, near, far)
        near, far = clip_to_grid(v0, ey / bed.spacing, nodes.shape[1] - 1.0, near, far)
        if far - near <= MERGED * bed.spacing:
            return 0
    if is_oblique(ex, ey):
        rows = bed.heights if v_is_y else bed.transposed
        count = walk_oblique(
            rows, bed.materials, bed.mapped, bed.periodic, bed.spacing, v_is_y, u0, v0, z, ex, ey, near, far, profile
        )
    else:
        count = _walk_strips(bed, GridWalk(nodes, v_is_y, u0, v0, z, ex, ey), near, far, profile)
    return measure_segments(count, ex, 1.0 / ey, bed, limits, profile) if count > 1 else count


@inlined_uncounted
def _walk_strips(bed, walk, near, far, profile):
    """Add the knots of all strips between two ground ranges to a profile; return their number."""
    u0, eu, spacing = walk.u0, walk.eu, bed.spacing
    column = _first_column(u0 + near * eu / spacing, eu, walk.nodes.shape[0], bed.periodic)
    start, count = near, 0
    while start < far:
        end = far
        if eu != 0.0:
            border = column + 1 if eu > 0.0 else column
            end = min(far, (border - u0) * spacing / eu)
        if end - start > MERGED * spacing:
            if count == 0:
                count = 1
                profile.x[0] = start
            count = _add_strip(bed, walk, column, start, end, count, profile)
            start = end
        elif end >= far:
            break
        column += 1 if eu > 0.0 else -1
    return count


@inlined_uncounted
def _add_strip(bed, walk, column, start, end, count, profile):
    """Add the knots of one strip: its first (already counted), the nodes within, its last; return the number of all."""
    nodes, v_is_y, u0, v0, z0, eu, ev = walk
    spacing = bed.spacing
    step = 1 if ev > 0.0 else -1
    v_start, v_end = v0 + start * ev / spacing, v0 + end * ev / spacing
    # Nodes from the one behind the first knot to the one beyond the last: all that the strip depends on.
    behind, beyond = first_line(v_start, step), first_line(v_end, -step)
    inner = max((beyond - behind) * step - 1, 0)
    nodes_read = padded_count(inner + 2)
    low, high = profile.low[:nodes_read], profile.high[:nodes_read]
    _read_row(nodes[wrap_index(column, nodes.shape[0])], behind, step, low)
    _read_row(nodes[wrap_index(column + 1, nodes.shape[0])], behind, step, high)
    head, segments = count - 1, inner + 1
    x, z, across = profile.x[head:], profile.z[head:], profile.across
    before = z[0]
    fu, du, x_behind, per_node = u0 - column, eu / spacing, (behind - v0) * spacing / ev, step * spacing / ev
    # Ground range, and how far into the strip the plane is, in cells: at the first node and from each to the next.
    steps = x_behind, per_node, fu + x_behind * du, per_node * du
    _place_knots(low, high, steps, z0, spacing, x, z, across)
    x[0], x[segments] = start, end
    # The ends lie between two nodes; the first is computed from the pair behind it, before that pair is overwritten.
    z_end, across_end = _interpolate(low, high, inner, (v_end - behind) * step - inner, fu + end * du, spacing)
    z_start, across[0] = _interpolate(low, high, 0, (v_start - behind) * step, fu + start * du, spacing)
    # Two strips share this knot; beside a hole in the bed only one of them has its height.
    z[0] = before if head > 0 and before == before else z_start - z0
    z[segments], across[segments] = z_end - z0, across_end
    _fill_gradients(padded_count(segments), across, profile.gradient[head:], profile.twist[head:])
    if bed.mapped:
        _fill_materials(bed.materials, v_is_y, column, behind, step, profile.material[head : head + segments])
    return head + segments + 1


@inlined_uncounted
def snap_to_grid(component):
    """Round a direction component within rounding error of 0 to 0, so that a track along the grid stays on it."""
    return 0.0 if abs(component) < 1e-12 else component


@inlined_uncounted
def _interpolate(low, high, node, fv, fu, spacing):
    """Bilinear height and cross-strip gradient at the fractions ``fv`` beyond a node and ``fu`` between the borders."""
    near = low[node] + np.float64(low[node + 1] - low[node]) * fv
    far = high[node] + np.float64(high[node + 1] - high[node]) * fv
    return near + (far - near) * fu, (far - near) / spacing


@inlined_uncounted
def _read_row(row, first, step, out):
    """Copy consecutive nodes of a row, ascending or descending and wrapped at its end, in contiguous runs."""
    done = 0
    while done < out.size:
        place = wrap_index(first + step * done, row.size)
        if step > 0:
            run = min(out.size - done, row.size - place)
            _copy(row[place : place + run], out[done : done + run])
        else:
            run = min(out.size - done, place + 1)
            _copy_reversed(row[place + 1 - run : place + 1], out[done : done + run])
        done += run


@inlined_uncounted
def _copy(source, out):
    """Copy entries in order."""
    for k in range(out.size):
        out[k] = source[k]


@inlined_uncounted
def _copy_reversed(source, out):
    """Copy entries in reverse order."""
    last = out.size - 1
    for k in range(out.size):
        # An index that might be negative prevents vectorisation.
        out[k] = source[np.uint64(last - k)]


@inlined_uncounted
def _place_knots(low, high, steps, z0, spacing, x, z, across):
    """Ground range, height above the sonar and gradient across the strip of the knots at a strip's nodes."""
    x_behind, per_node, fu, du = steps
    per_spacing = across.dtype.type(1.0 / spacing)
    for k in range(low.size):
        difference = high[k] - low[k]
        x[k] = x_behind + k * per_node
        z[k] = (low[k] - z0) + np.float64(difference) * (fu + k * du)
        across[k] = difference * per_spacing


@inlined_uncounted
def _fill_gradients(segments, across, gradient, twist):
    """Gradient across the strip at the middle of segments, and its change along them."""
    half = across.dtype.type(0.5)
    for i in range(segments):
        gradient[i] = half * (across[i] + across[i + 1])
        twist[i] = across[i + 1] - across[i]


@inlined_uncounted
def _fill_materials(materials, v_is_y, column, behind, step, out):
    """Material of each segment's cell."""
    rows, columns = materials.shape
    for k in range(out.size):
        # A cell belongs to its low corner.
        v = behind + step * k - (1 if step < 0 else 0)
        if v_is_y:
            out[k] = materials[wrap_index(v, rows), wrap_index(column, columns)]
        else:
            out[k] = materials[wrap_index(column, rows), wrap_index(v, columns)]


@inlined_uncounted
def _first_column(u, eu, nu, periodic):
    """Strip in which a walk from u starts; on a grid line, the strip that it enters."""
    column = math.floor(u + MERGED) if eu >= 0.0 else math.ceil(u - MERGED) - 1
    return column if periodic else min(max(column, 0), max(nu - 2, 0))
