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
    gradient_squared: NDArray[np.float64]  # |∇z|² at the middle of each segment
    material: NDArray[np.int64]  # row of the reflectivity table, each segment


def profile_capacity(reach: float, spacing: float) -> int:
    """Knots that a slice of the given reach can have at most."""
    return int(2.0 * math.sqrt(2.0) * reach / spacing) + 16


@kernel
def slice_bed(bed, x, y, z, ex, ey, reach, profile, scratch):
    """Fill ``profile`` along azimuth (ex, ey) from (x, y, z) out to ``reach``; return its number of knots."""
    u0, v0 = (x - bed.x0) / bed.spacing, (y - bed.y0) / bed.spacing
    if abs(ey) >= abs(ex):
        return _walk(bed, bed.transposed, True, u0, v0, z, ex, ey, reach, profile, scratch)
    return _walk(bed, bed.heights, False, v0, u0, z, ey, ex, reach, profile, scratch)


@kernel
def _walk(bed, nodes, v_is_y, u0, v0, z_sonar, eu, ev, reach, profile, scratch):
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
            count = _strip(bed, nodes, v_is_y, column, u0, v0, z_sonar, eu, ev, start, end, count, profile, scratch)
            start = end
        elif end >= far:
            break
        column += 1 if eu > 0.0 else -1
    return count


@kernel
def _strip(bed, nodes, v_is_y, column, u0, v0, z_sonar, eu, ev, start, end, count, profile, scratch):
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
    profile.z[head], scratch[0] = _edge(low, high, bed.periodic, u0 + start * eu / spacing - column, v_start, spacing)
    profile.z[head] -= z_sonar
    _nodes(low, high, first, step, inner, column, u0, v0, z_sonar, eu, ev, spacing, count, profile, scratch)
    tail = count + inner
    profile.x[tail] = end
    profile.z[tail], scratch[inner + 1] = _edge(
        low, high, bed.periodic, u0 + end * eu / spacing - column, v_end, spacing
    )
    profile.z[tail] -= z_sonar
    # Gradient: across the strip it is linear in v, along the plane it is the segment's own slope.
    for k in range(inner + 1):
        i = head + k
        across = 0.5 * (scratch[k] + scratch[k + 1])
        slope = (profile.z[i + 1] - profile.z[i]) / (profile.x[i + 1] - profile.x[i])
        along = (slope - eu * across) / ev
        profile.gradient_squared[i] = across * across + along * along
    _materials(
        bed.materials,
        v_is_y,
        column,
        nu,
        nv,
        math.floor(0.5 * (v_start + v_end)),
        first,
        step,
        inner,
        head,
        profile.material,
    )
    return tail + 1


@kernel
def _nodes(low, high, first, step, inner, column, u0, v0, z_sonar, eu, ev, spacing, count, profile, scratch):
    """Knots on consecutive nodes; runs that do not wrap let the compiler use its vector units."""
    nv = low.size
    done = 0
    per_node = spacing / ev
    while done < inner:
        place = (first + step * done) % nv
        run = min(inner - done, nv - place if step > 0 else place + 1)
        for k in range(run):
            x = (first + step * (done + k) - v0) * per_node
            near_height = np.float64(low[place + step * k])
            rise = np.float64(high[place + step * k]) - near_height
            profile.x[count + done + k] = x
            profile.z[count + done + k] = near_height + rise * (u0 + x * eu / spacing - column) - z_sonar
            scratch[1 + done + k] = rise / spacing
        done += run


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
def _materials(materials, v_is_y, column, nu, nv, cell, first, step, inner, head, out):
    """Material of each segment's cell."""
    for k in range(inner + 1):
        # The segment before node `first` lies in the cell that the plane leaves there.
        v = cell if inner == 0 else (first + step * k - (1 if step > 0 else 0))
        row, line = column % nu, v % nv
        out[head + k] = materials[line, row] if v_is_y else materials[row, line]


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
