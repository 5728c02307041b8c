"""Patches of targets' surfaces, each sampled evenly over its area."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.geometry.solids import FIRST_END, LAST_END, SIDE, frustum_normal

BALL, ROUND, FIRST_CAP, LAST_CAP, FACE = 0, 1, 2, 3, 4


class SurfacePatches(NamedTuple):
    """Patches, one row each: a belt of a sphere, a belt of a frustum's side, one of its ends, a triangle."""

    kind: NDArray[np.int64]  # (n,) BALL, ROUND, FIRST_CAP, LAST_CAP or FACE
    body: NDArray[np.int64]  # (n,) row of the solids; of a FACE, of the triangles
    target: NDArray[np.int64]  # (n,) index of the declared target
    number: NDArray[np.int64]  # (n,) of the patch among those of its target
    low: NDArray[np.float64]  # (n,) where a belt begins, m along the axis (of a sphere upwards, from its centre)
    high: NDArray[np.float64]  # (n,) and ends
    corners: NDArray[np.float64]  # (n, 3, 3) of a triangle
    area: NDArray[np.float64]  # (n,) m²
    centre: NDArray[np.float64]  # (n, 3) of a ball around it
    bound: NDArray[np.float64]  # (n,) and its radius, m


class SurfacePatch(NamedTuple):
    """One patch as plain numbers."""

    kind: int
    low: float
    high: float
    x: float  # centre of a sphere, or of a frustum's first end; the first corner of a triangle
    y: float
    z: float
    ax: float  # axis of a frustum; a triangle's normal
    ay: float
    az: float
    length: float
    radius: float
    taper: float
    bx: float  # from that corner of a triangle to the second
    by: float
    bz: float
    cx: float  # and to the third
    cy: float
    cz: float


class SurfacePoint(NamedTuple):
    """A point of a surface and the outward normal there."""

    x: float
    y: float
    z: float
    nx: float
    ny: float
    nz: float


@kernel
def load_patch(patches, row, solids, mesh):
    """Load a patch from the tables."""
    kind, body = patches.kind[row], patches.body[row]
    if kind == FACE:
        x, y, z = patches.corners[row, 0]
        bx, by, bz = patches.corners[row, 1] - patches.corners[row, 0]
        cx, cy, cz = patches.corners[row, 2] - patches.corners[row, 0]
        ax, ay, az = mesh.normal[body]
        patch = SurfacePatch(kind, 0.0, 0.0, x, y, z, ax, ay, az, 0.0, 0.0, 0.0, bx, by, bz, cx, cy, cz)
        return patch, mesh.material[body]
    x, y, z = solids.start[body]
    ax, ay, az = solids.axis[body]
    length, radius, taper = solids.length[body], solids.radius[body], solids.taper[body]
    low, high = patches.low[row], patches.high[row]
    patch = SurfacePatch(kind, low, high, x, y, z, ax, ay, az, length, radius, taper, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return patch, solids.material[body]


@inlined
def sample_patch(patch, u, v):
    """Point of a patch for two numbers, even over its area."""
    if patch.kind == FACE:
        # √u makes it even (Osada et al. 2002, *Shape distributions*).
        b, c = math.sqrt(u) * (1.0 - v), math.sqrt(u) * v
        x = patch.x + b * patch.bx + c * patch.cx
        y = patch.y + b * patch.by + c * patch.cy
        return SurfacePoint(x, y, patch.z + b * patch.bz + c * patch.cz, patch.ax, patch.ay, patch.az)
    turn = 2.0 * math.pi * v
    cos_turn, sin_turn = math.cos(turn), math.sin(turn)
    if patch.kind == BALL:
        # Belts of equal height have equal areas (Archimedes).
        nz = (patch.low + u * (patch.high - patch.low)) / patch.radius
        level = math.sqrt(max(1.0 - nz * nz, 0.0))
        nx, ny = level * cos_turn, level * sin_turn
        x, y, z = patch.x + patch.radius * nx, patch.y + patch.radius * ny, patch.z + patch.radius * nz
        return SurfacePoint(x, y, z, nx, ny, nz)
    return _sample_frustum(patch, u, cos_turn, sin_turn)


@inlined
def _sample_frustum(patch, u, cos_turn, sin_turn):
    """Point of a frustum's side or end for a number in [0, 1) and a direction round the axis."""
    face, ax, ay, az = SIDE, patch.ax, patch.ay, patch.az
    if patch.kind == ROUND:
        # Both on the side of a cone and on a disc the area within grows as the square of the radius.
        first, last = patch.radius + patch.taper * patch.low, patch.radius + patch.taper * patch.high
        off = math.sqrt(first * first + u * (last * last - first * first))
        axial = patch.low + (patch.high - patch.low) * (u if last == first else (off - first) / (last - first))
    else:
        face, axial = (FIRST_END, 0.0) if patch.kind == FIRST_CAP else (LAST_END, patch.length)
        off = (patch.radius + patch.taper * axial) * math.sqrt(u)
    # Two directions at right angles to the axis (Duff et al. 2017, *Building an orthonormal basis, revisited*).
    sign = math.copysign(1.0, az)
    a = -1.0 / (sign + az)
    b = ax * ay * a
    c, s = off * cos_turn, off * sin_turn
    px = axial * ax + c * (1.0 + sign * ax * ax * a) + s * b
    py = axial * ay + c * sign * b + s * (sign + ay * ay * a)
    pz = axial * az - c * sign * ax - s * ay
    nx, ny, nz = frustum_normal(px, py, pz, ax, ay, az, patch.radius, patch.taper, face)
    return SurfacePoint(patch.x + px, patch.y + py, patch.z + pz, nx, ny, nz)
