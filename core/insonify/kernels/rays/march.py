"""Hits of straight rays by marching in fixed steps: the first step below a surface is the hit.

The method may step over anything thinner than a step. A mesh has no inside to sample: its triangles are intersected
exactly.
"""

import math

import numpy as np

from insonify.compiler.jit import inlined_before_typing, kernel
from insonify.kernels.common.types import BED
from insonify.kernels.geometry.solids import greatest_radius, nearest_normal, signed_distance
from insonify.kernels.geometry.triangles import facing_normal, intersect_mesh
from insonify.kernels.rays.cell_walk import NO_HIT, Ray, cell_normal, load_bed_cell


@kernel
def march_hits(bed, solids, near, count, mesh, bundle, reach, step, hits):
    """First hit of each ray by marching: the first sample below the bed or inside a solid, interpolated once."""
    ceiling = _ceiling(bed, solids, near, count)
    for k in range(bundle.x.size):
        ray = Ray(bundle.x[k], bundle.y[k], bundle.z[k], bundle.dx[k], bundle.dy[k], bundle.dz[k])
        before, triangle = intersect_mesh(mesh, ray.x, ray.y, ray.z, ray.dx, ray.dy, ray.dz, reach)
        distance, body = _march(bed, solids, near, count, ray, ceiling, before, step)
        if triangle >= 0 and before < distance:
            distance, body, material = before, solids.shape.size + triangle, mesh.material[triangle]
            nx, ny, nz = facing_normal(mesh, triangle, ray.dx, ray.dy, ray.dz)
        else:
            material, nx, ny, nz = _surface_at(bed, solids, ray, distance, body)
        hits.distance[k], hits.body[k], hits.material[k] = distance, body, material
        hits.nx[k], hits.ny[k], hits.nz[k] = nx, ny, nz


@inlined_before_typing
def _march(bed, solids, near, count, ray, ceiling, reach, step):
    """Distance to the hit of one ray, and the body hit."""
    first, last = _sample_numbers(ray, ceiling, reach, step)
    before = _bed_clearance(bed, ray, (first - 1) * step)
    for k in range(first, last + 1):
        distance, body, before = _sample(bed, solids, near, count, ray, before, k * step, step)
        if body != NO_HIT:
            return distance, body
    return math.inf, NO_HIT


@inlined_before_typing
def _sample(bed, solids, near, count, ray, before, t, step):
    """Test the sample at distance t: distance of the surface crossed since the last sample, body, and clearance."""
    # ``before`` is the clearance above the bed of the last sample, a step nearer.
    best, body = math.inf, NO_HIT
    after = _bed_clearance(bed, ray, t)
    if after <= 0.0:
        share = before / (before - after) if 0.0 < before < math.inf else 1.0
        best, body = t - (1.0 - share) * step, BED
    for m in range(count):
        depth = _clearance(solids, near[m], ray, t)
        if depth <= 0.0:
            outside = _clearance(solids, near[m], ray, t - step)
            share = outside / (outside - depth) if outside > 0.0 else 0.0
            distance = t - (1.0 - share) * step
            if distance < best:
                best, body = distance, near[m]
    return best, body, after


@inlined_before_typing
def march_chord(bed, solids, near, count, ray, length):
    """Hit within one step of a ray, by the sample at its end."""
    distance, body, _ = _sample(bed, solids, near, count, ray, _bed_clearance(bed, ray, 0.0), length, length)
    material, nx, ny, nz = _surface_at(bed, solids, ray, distance, body)
    return distance, body, material, nx, ny, nz


@inlined_before_typing
def _surface_at(bed, solids, ray, distance, body):
    """Material and normal of what a ray meets at a distance."""
    if body == NO_HIT:
        return 0, 0.0, 0.0, 0.0
    if body == BED:
        row, column, u, v = _cell_beneath(bed, ray, distance)
        if row < 0:
            return 0, 0.0, 0.0, 0.0
        nx, ny, nz = cell_normal(load_bed_cell(bed.heights, row, column), u, v, bed.spacing)
        return np.int64(bed.materials[row, column]), nx, ny, nz
    x, y, z = ray.x + distance * ray.dx, ray.y + distance * ray.dy, ray.z + distance * ray.dz
    nx, ny, nz = nearest_normal(solids, body, x, y, z)
    return solids.material[body], nx, ny, nz


@kernel
def _ceiling(bed, solids, near, count):
    """Height above which there is neither bed nor solid, m."""
    ceiling = bed.high
    for m in range(count):
        k = near[m]
        ceiling = max(
            ceiling, solids.start[k, 2] + max(solids.axis[k, 2], 0.0) * solids.length[k] + greatest_radius(solids, k)
        )
    return ceiling


@kernel
def _sample_numbers(ray, ceiling, reach, step):
    """Numbers of the first and last samples of a ray: from the ceiling down, until one is out of reach."""
    last = math.ceil(reach / step)
    if ray.z <= ceiling:
        return 1, last
    if ray.dz >= 0.0:
        return 1, 0
    return max(1, int(min((ceiling - ray.z) / ray.dz / step, last + 1.0))), last


@inlined_before_typing
def _cell_beneath(bed, ray, t):
    """Cell of the bed below the point of a ray at distance t, and its place within the cell; row −1 outside the bed."""
    ny, nx = bed.heights.shape
    u, v = (ray.x + t * ray.dx - bed.x0) / bed.spacing, (ray.y + t * ray.dy - bed.y0) / bed.spacing
    i, j = math.floor(u), math.floor(v)
    if bed.periodic:
        return j % ny, i % nx, u - i, v - j
    if u < 0.0 or v < 0.0 or u > nx - 1.0 or v > ny - 1.0:
        return -1, -1, 0.0, 0.0
    i, j = min(i, max(nx - 2, 0)), min(j, max(ny - 2, 0))
    return j, i, u - i, v - j


@inlined_before_typing
def _bed_clearance(bed, ray, t):
    """Height above the bed of the point of a ray at distance t, infinite where there is no bed."""
    row, column, u, v = _cell_beneath(bed, ray, t)
    if row < 0:
        return math.inf
    cell = load_bed_cell(bed.heights, row, column)
    height = ray.z + t * ray.dz - (cell.a + cell.b * u + (cell.c + cell.d * u) * v)
    return height if height == height else math.inf


@inlined_before_typing
def _clearance(solids, k, ray, t):
    """Distance of the point of a ray at distance t from the surface of a solid, negative inside."""
    return signed_distance(solids, k, ray.x + t * ray.dx, ray.y + t * ray.dy, ray.z + t * ray.dz)
