"""Exact first hits of straight rays: a walk over the cells of the bilinear bed, the solids and the meshes.

Along a ray the height above one cell is a quadratic in distance. Its value at the border between two cells is carried
from one to the next, so no ray slips through a shared edge. The bed is solid and seen from above: a ray that comes
into it from the side or starts inside it ends there and returns no echo.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_before_typing, kernel
from insonify.kernels.bed.grid import clip_to_grid
from insonify.kernels.common.types import BED
from insonify.kernels.geometry.solids import intersect_solid
from insonify.kernels.geometry.triangles import intersect_mesh_bundle

NO_HIT = -2
SKIN = 1e-9  # share of the coordinates: a point closer to the bed is on it, and a ray that starts there does not hit it
FOREVER = 1e300

# Passing a scene's arrays from function to function, ray by ray, costs more than the walk itself.


class Ray(NamedTuple):
    """Where a ray starts, in metres, and its unit direction."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float


class RayBundle(NamedTuple):
    """Many rays: where each starts, in metres, and its unit direction, (n,) each."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]
    dx: NDArray[np.float64]
    dy: NDArray[np.float64]
    dz: NDArray[np.float64]


class Hits(NamedTuple):
    """The first thing that each ray meets, (n,) each."""

    distance: NDArray[np.float64]  # m, infinite if nothing is met
    body: NDArray[np.int64]  # row of the solids, beyond them of the triangles; BED or NO_HIT
    material: NDArray[np.int64]  # row of the reflectivity table
    nx: NDArray[np.float64]  # unit normal on the ray's side
    ny: NDArray[np.float64]
    nz: NDArray[np.float64]


class BilinearCell(NamedTuple):
    """Height over one cell of the bed, a + b u + c v + d u v with u, v in [0, 1], in metres."""

    a: float
    b: float
    c: float
    d: float


@kernel
def empty_bundle(n):
    """Room for n rays."""
    return RayBundle(np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@kernel
def empty_hits(n):
    """Room for n hits."""
    return Hits(np.empty(n), np.empty(n, np.int64), np.empty(n, np.int64), np.empty(n), np.empty(n), np.empty(n))


@kernel
def find_first_hits(bed, solids, near, count, mesh, bundle, reach, hits):
    """First hit of each ray on the bed, a mesh or a solid."""
    _meet_solids(solids, near, count, bundle, reach, hits)
    if mesh.skip.size > 0:
        intersect_mesh_bundle(solids, mesh, bundle, reach, hits)
    for k in range(bundle.x.size):
        ray = Ray(bundle.x[k], bundle.y[k], bundle.z[k], bundle.dx[k], bundle.dy[k], bundle.dz[k])
        limit = min(hits.distance[k], reach)
        distance, material, nx, ny, nz = meet_bed(bed, ray, limit)
        if distance < limit:
            hits.distance[k], hits.body[k], hits.material[k] = distance, BED, material
            hits.nx[k], hits.ny[k], hits.nz[k] = nx, ny, nz


@kernel
def _meet_solids(solids, near, count, bundle, reach, hits):
    """Initialise the hits with the nearest solid that each ray meets within ``reach``."""
    for k in range(bundle.x.size):
        hits.distance[k], hits.body[k], hits.material[k] = math.inf, NO_HIT, 0
        hits.nx[k], hits.ny[k], hits.nz[k] = 0.0, 0.0, 0.0
    for m in range(count):
        body = near[m]
        for k in range(bundle.x.size):
            distance, nx, ny, nz = intersect_solid(
                solids, body, bundle.x[k], bundle.y[k], bundle.z[k], bundle.dx[k], bundle.dy[k], bundle.dz[k]
            )
            if distance < min(hits.distance[k], reach):
                hits.distance[k], hits.body[k], hits.material[k] = distance, body, solids.material[body]
                hits.nx[k], hits.ny[k], hits.nz[k] = nx, ny, nz


@inlined_before_typing
def meet_bed(bed, ray, reach):
    """First point at which a ray meets the bed from above."""
    ny, nx = bed.heights.shape
    u0, v0 = (ray.x - bed.x0) / bed.spacing, (ray.y - bed.y0) / bed.spacing
    du, dv = ray.dx / bed.spacing, ray.dy / bed.spacing
    start, end = _height_span(bed, ray, reach)
    if not bed.periodic:
        start, end = clip_to_grid(u0, du, nx - 1.0, start, end)
        start, end = clip_to_grid(v0, dv, ny - 1.0, start, end)
    if not start < end:
        return math.inf, 0, 0.0, 0.0, 0.0
    i, j = _first_cell(u0 + start * du, du, nx, bed.periodic), _first_cell(v0 + start * dv, dv, ny, bed.periodic)
    column, row = i % nx, j % ny
    # Where the next grid lines are crossed; a ray along a family of lines never crosses it.
    per_u, per_v = 1.0 / du, 1.0 / dv
    ahead_u, ahead_v = (1 if du > 0.0 else 0), (1 if dv > 0.0 else 0)
    t_u = (i + ahead_u - u0) * per_u if du != 0.0 else FOREVER
    t_v = (j + ahead_v - v0) * per_v if dv != 0.0 else FOREVER
    skin = SKIN * (bed.spacing + abs(ray.z) + abs(start))
    above, known = 0.0, False
    while start < end:
        stop = max(min(t_u, t_v, end), start)
        cell = load_bed_cell(bed.heights, row, column)
        # NaN at any corner makes this NaN: no bed here.
        after = _clearance(cell, u0 + stop * du - i, v0 + stop * dv - j, ray.z + stop * ray.dz)
        if after == after:
            if not known:
                above = _clearance(cell, u0 + start * du - i, v0 + start * dv - j, ray.z + start * ray.dz)
                if above < -skin:
                    return math.nan, 0, 0.0, 0.0, 0.0
                above, known = max(above, skin), True
            span = stop - start
            share = _first_root(above, after, -cell.d * du * dv * span * span)
            if share <= 1.0:
                distance = start + share * span
                mx, my, mz = cell_normal(cell, u0 + distance * du - i, v0 + distance * dv - j, bed.spacing)
                return distance, np.int64(bed.materials[row, column]), mx, my, mz
        else:
            known = False
        above, start = after, stop
        if t_u <= t_v:
            i, column = _next_cell(i, column, ahead_u, nx)
            t_u = (i + ahead_u - u0) * per_u
        else:
            j, row = _next_cell(j, row, ahead_v, ny)
            t_v = (j + ahead_v - v0) * per_v
    return math.inf, 0, 0.0, 0.0, 0.0


@kernel
def _next_cell(cell, node, forwards, nodes):
    """Next cell along one axis, and its low node, which wraps."""
    if forwards:
        return cell + 1, (node + 1 if node + 1 < nodes else 0)
    return cell - 1, (node - 1 if node > 0 else nodes - 1)


@inlined_before_typing
def load_bed_cell(heights, row, column):
    """Bilinear coefficients of a cell of the bed."""
    ny, nx = heights.shape
    across = column + 1 if column + 1 < nx else 0
    along = row + 1 if row + 1 < ny else 0
    a = np.float64(heights[row, column])
    b = np.float64(heights[row, across]) - a
    c = np.float64(heights[along, column]) - a
    return BilinearCell(a, b, c, np.float64(heights[along, across]) - a - b - c)


@inlined_before_typing
def _first_root(above, after, bend):
    """Share of [0, 1] at which above + (after − above − bend) s + bend s² first falls to zero, 2 if never."""
    # ``above`` is positive. A fall below zero always gives a root, whatever the rounding.
    slope = after - above - bend
    if after > 0.0 and not (bend > 0.0 and slope < 0.0 and -slope < 2.0 * bend):
        return 2.0
    root = slope * slope - 4.0 * bend * above
    if root < 0.0:
        if after > 0.0:
            return 2.0
        root = 0.0
    # The root without cancellation: both terms of the denominator have the same sign.
    root = math.sqrt(root)
    share = 2.0 * above / (root - slope) if slope <= 0.0 else -0.5 * (slope + root) / bend
    return min(max(share, 0.0), 1.0)


@inlined_before_typing
def cell_normal(cell, u, v, spacing):
    """Upward unit normal of a bilinear cell."""
    p, q = (cell.b + cell.d * v) / spacing, (cell.c + cell.d * u) / spacing
    norm = 1.0 / math.sqrt(1.0 + p * p + q * q)
    return -p * norm, -q * norm, norm


@inlined_before_typing
def _clearance(cell, u, v, z):
    """Height of a point above the surface of a cell, m."""
    return z - (cell.a + cell.b * u + (cell.c + cell.d * u) * v)


@inlined_before_typing
def _height_span(bed, ray, reach):
    """Distances between which a ray is between the bed's lowest and highest heights."""
    margin = 1e-6 * (bed.spacing + abs(bed.low) + abs(bed.high))
    if ray.dz == 0.0:
        return (0.0, reach) if bed.low - margin <= ray.z <= bed.high + margin else (1.0, 0.0)
    one, other = (bed.low - margin - ray.z) / ray.dz, (bed.high + margin - ray.z) / ray.dz
    return max(0.0, min(one, other)), min(reach, max(one, other))


@kernel
def _first_cell(u, rate, nodes, periodic):
    """Cell in which a walk begins; on a grid line, the one it goes into."""
    cell = math.floor(u)
    if rate < 0.0 and u == cell:
        cell -= 1
    if not periodic:
        cell = min(max(cell, 0), max(nodes - 2, 0))
    return cell
