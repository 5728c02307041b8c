"""Cut the bed with a vertical half-plane through the sonar: any grid, any azimuth, out comes one profile.

Knots lie where the plane crosses *both* families of grid lines, so that every segment belongs to one cell.
The grid is walked in strips between neighbouring lines of the sparser family; within a strip the knots lie on
consecutive nodes of two rows of memory, which is what makes the walk cheap at any azimuth.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.jit import kernel

# Knots closer to a grid corner than this share of a cell merge with it.
MERGED = 1e-6


class Profile(NamedTuple):
    """One slice; n knots make n - 1 segments, arrays are longer than n."""

    x: NDArray[np.float64]  # ground range of the knots from the sonar, m
    z: NDArray[np.float64]  # height of the knots above the sonar, m
    slope: NDArray[np.float64]  # dz/dx of each segment
    area: NDArray[np.float64]  # 1 + |∇z|² at the middle of each segment: squared area over its level projection
    material: NDArray[np.int64]  # row of the reflectivity table, each segment
    across: NDArray[np.float64]  # work space: gradient across the strip, at its knots
    low: NDArray[np.float64]  # work space: heights on the strip's lower border
    high: NDArray[np.float64]  # work space: heights on its upper border


def empty_profile(capacity: int) -> Profile:
    """Make room for profiles of up to ``capacity`` knots."""
    columns = [np.zeros(capacity) for _ in range(4)]
    work = [np.zeros(capacity) for _ in range(3)]
    return Profile(*columns, np.zeros(capacity, np.int64), *work)


def profile_capacity(reach: float, spacing: float) -> int:
    """Knots that a slice of the given reach can have at most."""
    return int(2.0 * math.sqrt(2.0) * reach / spacing) + 16


@kernel
def slice_bed(bed, x, y, z, ex, ey, reach, profile):
    """Fill ``profile`` along azimuth (ex, ey) from (x, y, z) out to ``reach``; return its number of knots."""
    u0, v0 = (x - bed.x0) / bed.spacing, (y - bed.y0) / bed.spacing
    if abs(ey) >= abs(ex):
        count = _walk(bed, bed.transposed, True, u0, v0, ex, ey, reach, profile)
    else:
        count = _walk(bed, bed.heights, False, v0, u0, ey, ex, reach, profile)
    if not bed.mapped:
        profile.material[:count] = bed.materials[0, 0]
    for k in range(count):
        profile.z[k] -= z
    return count


@kernel
def _walk(bed, nodes, v_is_y, u0, v0, eu, ev, reach, profile):
    """Walk strip by strip; v is the axis crossed most often, ``nodes[u, v]`` its heights."""
    nu, nv = nodes.shape
    spacing = bed.spacing
    near, far = 0.0, reach
    if not bed.periodic:
        near, far = _clip(u0, eu / spacing, nu - 1.0, near, far)
        near, far = _clip(v0, ev / spacing, nv - 1.0, near, far)
        if far - near <= MERGED * spacing:
            return 0
    column = _first_column(u0 + near * eu / spacing, eu, nu, bed.periodic)
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
            count = _strip(bed, nodes, v_is_y, column, u0, v0, eu, ev, start, end, count, profile)
            start = end
        elif end >= far:
            break
        column += 1 if eu > 0.0 else -1
    return count


@kernel
def _strip(bed, nodes, v_is_y, column, u0, v0, eu, ev, start, end, count, profile):
    """Add the knots of one strip: its first (already counted), the nodes within, its last."""
    nu, nv = nodes.shape
    spacing = bed.spacing
    if bed.periodic:
        low, high = nodes[column % nu], nodes[(column + 1) % nu]
    else:
        low, high = nodes[column], nodes[min(column + 1, nu - 1)]
    v_start, v_end = v0 + start * ev / spacing, v0 + end * ev / spacing
    if ev > 0.0:
        first, last, step = math.floor(v_start + MERGED) + 1, math.ceil(v_end - MERGED) - 1, 1
        inner = last - first + 1
    else:
        first, last, step = math.ceil(v_start - MERGED) - 1, math.floor(v_end + MERGED) + 1, -1
        inner = first - last + 1
    inner = max(inner, 0)
    head = count - 1
    tail = count + inner
    fu, du = u0 - column, eu / spacing
    profile.z[head], profile.across[0] = _edge(low, high, bed.periodic, fu + start * du, v_start, spacing)
    profile.z[tail], profile.across[inner + 1] = _edge(low, high, bed.periodic, fu + end * du, v_end, spacing)
    profile.x[tail] = end
    per_node = step * spacing / ev
    _even((first - v0) * spacing / ev, per_node, profile.x[count:tail])
    _row(low, first, step, profile.low[:inner])
    _row(high, first, step, profile.high[:inner])
    _blend(profile.low, profile.high, fu + profile.x[count] * du, per_node * du, profile.z[count:tail])
    _rise(profile.low, profile.high, 1.0 / spacing, profile.across[1 : inner + 1])
    _slopes(profile.x[head : tail + 1], profile.z[head : tail + 1], profile.slope[head:tail])
    _areas(profile.across, profile.slope[head:tail], eu, 1.0 / ev, profile.area[head:tail])
    if bed.mapped:
        cell = math.floor(0.5 * (v_start + v_end))
        _materials(bed.materials, v_is_y, column, nu, nv, cell, first, step, profile.material[head:tail])
    return tail + 1


@kernel
def _even(start, step, x):
    for k in range(x.size):
        x[k] = start + k * step


@kernel
def _row(row, first, step, out):
    """Read consecutive nodes of a row, upward or downward, round its end; runs suit the vector units."""
    done = 0
    while done < out.size:
        place = (first + step * done) % row.size
        if step > 0:
            run = min(out.size - done, row.size - place)
            source = row[place : place + run]
            for k in range(run):
                out[done + k] = source[k]
        else:
            run = min(out.size - done, place + 1)
            source = row[place + 1 - run : place + 1]
            for k in range(run):
                out[done + k] = source[run - 1 - k]
        done += run


@kernel
def _blend(low, high, fu, dfu, z):
    for k in range(z.size):
        z[k] = low[k] + (high[k] - low[k]) * (fu + k * dfu)


@kernel
def _rise(low, high, per_spacing, across):
    for k in range(across.size):
        across[k] = (high[k] - low[k]) * per_spacing


@kernel
def _slopes(x, z, slope):
    for i in range(slope.size):
        slope[i] = (z[i + 1] - z[i]) / (x[i + 1] - x[i])


@kernel
def _areas(across, slope, eu, per_ev, area):
    """Across the strip the gradient is linear in v; along the plane it is the segment's own slope."""
    for i in range(area.size):
        middle = 0.5 * (across[i] + across[i + 1])
        along = (slope[i] - eu * middle) * per_ev
        area[i] = 1.0 + middle * middle + along * along


@kernel
def _edge(low, high, periodic, fu, v, spacing):
    """Bilinear height and gradient across the strip at its border."""
    nv = low.size
    node = math.floor(v)
    if not periodic:
        node = min(max(node, 0), max(nv - 2, 0))
    fv = v - node
    if periodic:
        node, following = node % nv, (node + 1) % nv
    else:
        following = min(node + 1, nv - 1)
    near = low[node] * (1.0 - fv) + low[following] * fv
    far = high[node] * (1.0 - fv) + high[following] * fv
    return near + (far - near) * fu, (far - near) / spacing


@kernel
def _materials(materials, v_is_y, column, nu, nv, cell, first, step, out):
    """Material of each segment's cell."""
    for k in range(out.size):
        # The segment before node `first` lies in the cell that the plane leaves there.
        v = cell if out.size == 1 else first + step * k - (1 if step > 0 else 0)
        row, line = column % nu, v % nv
        out[k] = materials[line, row] if v_is_y else materials[row, line]


@kernel
def _clip(origin, rate, highest, near, far):
    """Part of [near, far] where origin + t rate lies within [0, highest]."""
    if rate == 0.0:
        return (near, far) if 0.0 <= origin <= highest else (1.0, 0.0)
    one, other = -origin / rate, (highest - origin) / rate
    return max(near, min(one, other)), min(far, max(one, other))


@kernel
def _first_column(u, eu, nu, periodic):
    """Strip in which a walk from u starts; on a line, the one it goes into."""
    column = math.floor(u + MERGED) if eu >= 0.0 else math.ceil(u - MERGED) - 1
    return column if periodic else min(max(column, 0), max(nu - 2, 0))
