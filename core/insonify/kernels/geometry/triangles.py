"""Watertight intersection of rays with triangles: no ray slips between two that share an edge.

Woop, Benthin and Wald (2013), "Watertight ray/triangle intersection": the corners are sheared so that the ray runs
along the third axis, and three areas in the plane across it tell whether it passes inside. In plain IEEE arithmetic a
difference of two products is never of the wrong sign, at worst 0, and two triangles see their common edge with areas
exactly opposite. As 0 counts as inside, one of them is always met.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined, inlined_ieee, kernel

MARGIN = 1e-12  # share of all lengths by which boxes grow, so that rounding never misses one
NO_TRIANGLE = -1
LEVEL = 1e300  # stands for one over a component that is zero


class Shear(NamedTuple):
    """Sheared axes of one ray's triangle test, in which the ray runs along the third axis."""

    along: int  # axis in which it goes fastest
    first: int  # the other two
    second: int
    x: float  # origin, in that order
    y: float
    z: float
    sx: float  # the shear
    sy: float
    sz: float


@kernel
def intersect_mesh_bundle(solids, mesh, bundle, reach, hits):
    """Intersect a bundle of rays with all triangles and keep the hits nearer than those found so far."""
    for k in range(bundle.x.size):
        x, y, z, dx, dy, dz = bundle.x[k], bundle.y[k], bundle.z[k], bundle.dx[k], bundle.dy[k], bundle.dz[k]
        distance, triangle = intersect_mesh(mesh, x, y, z, dx, dy, dz, min(hits.distance[k], reach))
        if triangle >= 0:
            hits.distance[k], hits.body[k] = distance, solids.shape.size + triangle
            hits.material[k] = mesh.material[triangle]
            hits.nx[k], hits.ny[k], hits.nz[k] = facing_normal(mesh, triangle, dx, dy, dz)


@inlined
def intersect_mesh(mesh, x, y, z, dx, dy, dz, reach):
    """Intersect a ray with the nearest triangle, seen from either side."""
    shear = _shear_ray(x, y, z, dx, dy, dz)
    rx, ry, rz = _reciprocal(dx), _reciprocal(dy), _reciprocal(dz)
    margin = MARGIN * (1.0 + abs(x) + abs(y) + abs(z) + min(reach, 1e9))
    best, found, node = reach, NO_TRIANGLE, 0
    while node < mesh.skip.size:
        near, far = _clip_to_slab(mesh.low[node, 0] - x, mesh.high[node, 0] - x, rx, margin, 0.0, best)
        near, far = _clip_to_slab(mesh.low[node, 1] - y, mesh.high[node, 1] - y, ry, margin, near, far)
        near, far = _clip_to_slab(mesh.low[node, 2] - z, mesh.high[node, 2] - z, rz, margin, near, far)
        if near > far:
            node = mesh.skip[node]
            continue
        for triangle in range(mesh.first[node], mesh.first[node] + mesh.leaf_size[node]):
            distance = _intersect_triangle(mesh.corners, triangle, shear)
            if 0.0 < distance < best:
                best, found = distance, triangle
        node += 1
    return best, found


@inlined
def facing_normal(mesh, triangle, dx, dy, dz):
    """Turn the normal of a triangle against a ray."""
    nx, ny, nz = mesh.normal[triangle, 0], mesh.normal[triangle, 1], mesh.normal[triangle, 2]
    turned = -1.0 if nx * dx + ny * dy + nz * dz > 0.0 else 1.0
    return turned * nx, turned * ny, turned * nz


@inlined
def _shear_ray(x, y, z, dx, dy, dz):
    """Choose axes in which a ray runs along the third."""
    along = 2
    if abs(dx) > abs(dy) and abs(dx) > abs(dz):
        along = 0
    elif abs(dy) > abs(dz):
        along = 1
    if along == 0:
        return Shear(0, 1, 2, y, z, x, dy / dx, dz / dx, 1.0 / dx)
    if along == 1:
        return Shear(1, 2, 0, z, x, y, dz / dy, dx / dy, 1.0 / dy)
    return Shear(2, 0, 1, x, y, z, dx / dz, dy / dz, 1.0 / dz)


@inlined_ieee
def _intersect_triangle(corners, triangle, shear):
    """Distance along a ray to a triangle, edges and corners included; negative behind, infinite if missed."""
    az = corners[triangle, 0, shear.along] - shear.z
    bz = corners[triangle, 1, shear.along] - shear.z
    cz = corners[triangle, 2, shear.along] - shear.z
    ax = (corners[triangle, 0, shear.first] - shear.x) - shear.sx * az
    ay = (corners[triangle, 0, shear.second] - shear.y) - shear.sy * az
    bx = (corners[triangle, 1, shear.first] - shear.x) - shear.sx * bz
    by = (corners[triangle, 1, shear.second] - shear.y) - shear.sy * bz
    cx = (corners[triangle, 2, shear.first] - shear.x) - shear.sx * cz
    cy = (corners[triangle, 2, shear.second] - shear.y) - shear.sy * cz
    u, v, w = cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax
    if (u < 0.0 or v < 0.0 or w < 0.0) and (u > 0.0 or v > 0.0 or w > 0.0):
        return math.inf
    whole = u + v + w
    # A triangle seen exactly edge-on is not hit.
    if whole == 0.0:
        return math.inf
    return shear.sz * (u * az + v * bz + w * cz) / whole


@inlined
def _reciprocal(component):
    """Inverse of a component of a direction; for a component of zero, a value greater than any length."""
    return LEVEL if component == 0.0 else 1.0 / component


@inlined
def _clip_to_slab(low, high, per, margin, near, far):
    """Part of a stretch of a ray that lies between two faces of a box."""
    one, other = (low - margin) * per, (high + margin) * per
    return max(near, min(one, other)), min(far, max(one, other))
