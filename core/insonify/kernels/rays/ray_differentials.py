"""Width of a thin tube of rays, from the derivatives of one ray (Igehy 1999, "Tracing ray differentials").

A ray has two differentials: how its place and direction move per radian of its elevation at the sonar, and per radian
at right angles to that. The cross product of the two shifts of a place is the area that a unit of solid angle covers.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined
from insonify.kernels.common.types import SPHERE


class RayDifferential(NamedTuple):
    """Derivative of a ray's place, m/rad, and of its direction."""

    x: float
    y: float
    z: float
    dx: float
    dy: float
    dz: float


@inlined
def start_elevation_differential(dx, dy, dz):
    """Differential of a ray at the sonar with its elevation, per radian."""
    level = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    return RayDifferential(0.0, 0.0, 0.0, -dz * dx / level, -dz * dy / level, level)


@inlined
def start_azimuth_differential(dx, dy):
    """Differential of a ray at the sonar with an angle at right angles to the elevation, per radian."""
    level = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    return RayDifferential(0.0, 0.0, 0.0, -dy / level, dx / level, 0.0)


@inlined
def transfer(shift, path, surface):
    """Carry a differential to the surface that a ray meets, along whose tangent its place then moves."""
    dx, dy, dz, nx, ny, nz = path.dx, path.dy, path.dz, surface.nx, surface.ny, surface.nz
    t = surface.distance
    x, y, z = shift.x + t * shift.dx, shift.y + t * shift.dy, shift.z + t * shift.dz
    on = (nx * x + ny * y + nz * z) / (nx * dx + ny * dy + nz * dz)  # Igehy 1999: transfer
    return RayDifferential(x - on * dx, y - on * dy, z - on * dz, shift.dx, shift.dy, shift.dz)


@inlined
def reflect(shift, cosine, path, surface, bent):
    """Differential of a ray after specular reflection."""
    dx, dy, dz, nx, ny, nz = path.dx, path.dy, path.dz, surface.nx, surface.ny, surface.nz
    # Igehy 1999: reflection
    fall = shift.dx * nx + shift.dy * ny + shift.dz * nz + dx * bent[0] + dy * bent[1] + dz * bent[2]
    return RayDifferential(
        shift.x, shift.y, shift.z,
        shift.dx + 2.0 * (cosine * bent[0] - fall * nx),
        shift.dy + 2.0 * (cosine * bent[1] - fall * ny),
        shift.dz + 2.0 * (cosine * bent[2] - fall * nz),
    )  # fmt: skip


@inlined
def refract(shift, cosine, speeds, root, path, surface, bent):
    """Differential of a ray after refraction into or out of a body."""
    dx, dy, dz, nx, ny, nz = path.dx, path.dy, path.dz, surface.nx, surface.ny, surface.nz
    # Igehy 1999: refraction, of Snell's law d' = ν d + (ν cos α − √root) n
    fall = -(shift.dx * nx + shift.dy * ny + shift.dz * nz + dx * bent[0] + dy * bent[1] + dz * bent[2])
    bend, growth = speeds * cosine - root, (speeds - speeds * speeds * cosine / root) * fall
    return RayDifferential(
        shift.x, shift.y, shift.z,
        speeds * shift.dx + bend * bent[0] + growth * nx,
        speeds * shift.dy + bend * bent[1] + growth * ny,
        speeds * shift.dz + bend * bent[2] + growth * nz,
    )  # fmt: skip


@inlined
def differentiate_normal(solids, shift, path, surface):
    """Change of a surface's normal along a differential; zero on facets and on the bed's cells."""
    k, nx, ny, nz = surface.body, surface.nx, surface.ny, surface.nz
    if not 0 <= k < solids.shape.size:
        return 0.0, 0.0, 0.0
    px, py, pz = path.x - solids.start[k, 0], path.y - solids.start[k, 1], path.z - solids.start[k, 2]
    if solids.shape[k] == SPHERE:
        # Positive where the normal points outwards.
        over = math.copysign(1.0 / solids.radius[k], px * nx + py * ny + pz * nz)
        return shift.x * over, shift.y * over, shift.z * over
    ax, ay, az, taper = solids.axis[k, 0], solids.axis[k, 1], solids.axis[k, 2], solids.taper[k]
    slope = math.sqrt(1.0 + taper * taper)
    if abs(abs(nx * ax + ny * ay + nz * az) * slope - abs(taper)) > 1e-6 * slope:
        return 0.0, 0.0, 0.0
    along = px * ax + py * ay + pz * az
    rx, ry, rz = px - along * ax, py - along * ay, pz - along * az
    radius = max(math.sqrt(rx * rx + ry * ry + rz * rz), 1e-300)
    # The side is curved around the axis and straight along it.
    cx, cy, cz = (ay * rz - az * ry) / radius, (az * rx - ax * rz) / radius, (ax * ry - ay * rx) / radius
    over = math.copysign(1.0 / (radius * slope), rx * nx + ry * ny + rz * nz)
    over *= shift.x * cx + shift.y * cy + shift.z * cz
    return over * cx, over * cy, over * cz


@inlined
def tube_area(up, across):
    """Area that a unit of solid angle covers where both differentials of a ray have landed, m²/sr."""
    x, y, z = up.y * across.z - up.z * across.y, up.z * across.x - up.x * across.z, up.x * across.y - up.y * across.x
    return math.sqrt(x * x + y * y + z * z)
