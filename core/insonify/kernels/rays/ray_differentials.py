"""How a thin tube of rays widens, by the derivatives of one ray (Igehy 1999, "Tracing ray differentials").

A tube keeps how its ray's place and direction move with the elevation and, at right angles to it, across: per radian
both, so that the cross product of the two shifts of a place is the area that a unit of solid angle covers there.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.kernels.common.jit import inlined
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
    """Begin the edge that grows with the elevation."""
    level = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    return RayDifferential(0.0, 0.0, 0.0, -dz * dx / level, -dz * dy / level, level)


@inlined
def start_azimuth_differential(dx, dy):
    """Begin the edge that grows across."""
    level = max(math.sqrt(dx * dx + dy * dy), 1e-300)
    return RayDifferential(0.0, 0.0, 0.0, -dy / level, dx / level, 0.0)


@inlined
def transfer(shift, distance, dx, dy, dz, nx, ny, nz):
    """Carry an edge to a surface, along whose tangent its place then moves."""
    x, y, z = (
        shift.x + distance * shift.dx,
        shift.y + distance * shift.dy,
        shift.z + distance * shift.dz,
    )
    on = (nx * x + ny * y + nz * z) / (nx * dx + ny * dy + nz * dz)
    return RayDifferential(x - on * dx, y - on * dy, z - on * dz, shift.dx, shift.dy, shift.dz)


@inlined
def reflect(shift, cosine, dx, dy, dz, nx, ny, nz, bent):
    """Turn an edge with a ray that a mirror turns; ``bent`` is how the normal moves with the edge's place."""
    fall = shift.dx * nx + shift.dy * ny + shift.dz * nz + dx * bent[0] + dy * bent[1] + dz * bent[2]
    return RayDifferential(
        shift.x, shift.y, shift.z,
        shift.dx + 2.0 * (cosine * bent[0] - fall * nx),
        shift.dy + 2.0 * (cosine * bent[1] - fall * ny),
        shift.dz + 2.0 * (cosine * bent[2] - fall * nz),
    )  # fmt: skip


@inlined
def refract(shift, cosine, speeds, root, dx, dy, dz, nx, ny, nz, bent):
    """Turn an edge with a ray that passes on: d' = ν d + (ν cos α − √root) n, as Snell's law has it."""
    fall = -(shift.dx * nx + shift.dy * ny + shift.dz * nz + dx * bent[0] + dy * bent[1] + dz * bent[2])
    bend, growth = speeds * cosine - root, (speeds - speeds * speeds * cosine / root) * fall
    return RayDifferential(
        shift.x, shift.y, shift.z,
        speeds * shift.dx + bend * bent[0] + growth * nx,
        speeds * shift.dy + bend * bent[1] + growth * ny,
        speeds * shift.dz + bend * bent[2] + growth * nz,
    )  # fmt: skip


@inlined
def differentiate_normal(solids, k, shift, x, y, z, nx, ny, nz):
    """How the normal (nx, ny, nz) of body k at a point moves with an edge's place; flat faces have none."""
    px, py, pz = x - solids.start[k, 0], y - solids.start[k, 1], z - solids.start[k, 2]
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
    # Around the axis the side bends, along its lines it does not.
    cx, cy, cz = (ay * rz - az * ry) / radius, (az * rx - ax * rz) / radius, (ax * ry - ay * rx) / radius
    over = math.copysign(1.0 / (radius * slope), rx * nx + ry * ny + rz * nz)
    over *= shift.x * cx + shift.y * cy + shift.z * cz
    return over * cx, over * cy, over * cz


@inlined
def tube_area(up, across):
    """Area that a unit of solid angle covers where two edges have landed, m²/sr."""
    x, y, z = up.y * across.z - up.z * across.y, up.z * across.x - up.x * across.z, up.x * across.y - up.y * across.x
    return math.sqrt(x * x + y * y + z * z)
