"""Rays against analytic bodies: exact distances and outward normals."""

from __future__ import annotations

import math

from insonify.kernels.jit import fused, kernel
from insonify.kernels.types import SPHERE

MISSED = math.inf


@fused
def meet_solid(solids, k, x, y, z, dx, dy, dz):
    """Meet body k along a unit direction: (distance, nx, ny, nz), the distance infinite if the ray misses."""
    cx, cy, cz = solids.start[k, 0] - x, solids.start[k, 1] - y, solids.start[k, 2] - z
    if solids.shape[k] == SPHERE:
        return _meet_sphere(cx, cy, cz, solids.radius[k], dx, dy, dz)
    axis = solids.axis[k]
    return _meet_cylinder(cx, cy, cz, axis[0], axis[1], axis[2], solids.length[k], solids.radius[k], dx, dy, dz)


@kernel
def _meet_sphere(cx, cy, cz, radius, dx, dy, dz):
    along = cx * dx + cy * dy + cz * dz
    # The perpendicular, not c² − along², keeps its digits far away.
    px, py, pz = cx - along * dx, cy - along * dy, cz - along * dz
    root = radius * radius - (px * px + py * py + pz * pz)
    if root < 0.0:
        return MISSED, 0.0, 0.0, 0.0
    distance = along - math.sqrt(root)
    if distance <= 0.0:
        return MISSED, 0.0, 0.0, 0.0
    return distance, (distance * dx - cx) / radius, (distance * dy - cy) / radius, (distance * dz - cz) / radius


@kernel
def _meet_cylinder(cx, cy, cz, ax, ay, az, length, radius, dx, dy, dz):
    """Side first, then the flat ends; seen from outside the nearer of the two is the hit."""
    da, ca = dx * ax + dy * ay + dz * az, cx * ax + cy * ay + cz * az
    ex, ey, ez = dx - da * ax, dy - da * ay, dz - da * az
    gx, gy, gz = cx - ca * ax, cy - ca * ay, cz - ca * az
    squared = ex * ex + ey * ey + ez * ez
    if squared > 1e-18:
        along = (ex * gx + ey * gy + ez * gz) / squared
        px, py, pz = gx - along * ex, gy - along * ey, gz - along * ez
        root = (radius * radius - (px * px + py * py + pz * pz)) / squared
        if root < 0.0:
            return MISSED, 0.0, 0.0, 0.0
        distance = along - math.sqrt(root)
        axial = distance * da - ca
        if distance > 0.0 and 0.0 <= axial <= length:
            nx, ny, nz = distance * ex - gx, distance * ey - gy, distance * ez - gz
            return distance, nx / radius, ny / radius, nz / radius
    if da == 0.0:
        return MISSED, 0.0, 0.0, 0.0
    end, side = (0.0, -1.0) if da > 0.0 else (length, 1.0)
    distance = (end + ca) / da
    px, py, pz = distance * ex - gx, distance * ey - gy, distance * ez - gz
    if distance <= 0.0 or px * px + py * py + pz * pz > radius * radius:
        return MISSED, 0.0, 0.0, 0.0
    return distance, side * ax, side * ay, side * az
