"""Where rays are sent and what each stands for.

On a level bed the rays of the main stratum hit at equal steps of slant range; a second stratum takes the elevations
above it, up to the highest thing there is to see. Across a fan beam azimuths follow the golden ratio, over the exact
width of the cone |sin φ_b| = cos θ |sin φ| <= sin(w/2) at each elevation.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.jit import kernel
from insonify.kernels.shapes import widest
from insonify.kernels.types import LIGHT, SPHERE

AIM_STEPS = 64.0  # per radian
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class Beam(NamedTuple):
    """One side of one ping."""

    x: float
    y: float
    z: float
    ahead_x: float  # unit vector of the heading
    ahead_y: float
    side_x: float  # and at right angles to it, to that side
    side_y: float
    half_width: float  # rad
    reach: float  # m


class Launch(NamedTuple):
    """Rays of one side, in the sonar's own axes."""

    ahead: NDArray[np.float64]  # (n,) unit directions
    abeam: NDArray[np.float64]  # (n,)
    up: NDArray[np.float64]  # (n,)
    weight: NDArray[np.float64]  # (n,) rad (knife, and every beam of law `light`) or sr (fan of law `sonar`)


@kernel
def aim(launch, height, top, reach, half_width, law):
    """Aim all rays of a side.

    ``height`` of the sonar above the mean bed, ``top`` the highest elevation there is to see (radians, up positive).
    """
    n = launch.up.size
    level = height > 0.0 and height < reach
    lowest = -math.asin(height / reach) if level else -0.5 * math.pi
    main = n - _upper_rays(n, height, reach, lowest, top) if level else 0
    for k in range(main):
        r_near = height + (reach - height) * k / main
        r_far = height + (reach - height) * (k + 1) / main
        r = 0.5 * (r_near + r_far)
        theta = math.asin(height / r)
        steep = math.asin(min(height / r_near, 1.0))
        shallow = math.asin(height / r_far)
        # Exactly a step of slant range on a level bed for law `light`, exactly the angle for law `sonar`.
        angle = (r_far - r_near) * math.tan(theta) / r if law == LIGHT else steep - shallow
        _send(launch, k, -theta, angle, height / r_near - height / r_far, half_width, law)
    step = (top - lowest) / max(n - main, 1)
    for k in range(main, n):
        low = lowest + (k - main) * step
        band = math.sin(low + step) - math.sin(low)
        _send(launch, k, low + 0.5 * step, step, band, half_width, law)


@kernel
def _upper_rays(n, height, reach, lowest, top):
    """Rays for the elevations above the level bed: as dense as the main stratum's last, at most half of all."""
    if top <= lowest:
        return 0
    # dr/dθ of a level bed at the end of the range turns the angle into metres of slant range.
    equivalent = (top - lowest) * reach * math.sqrt(reach * reach - height * height) / height
    return min(n // 2, math.ceil(n * equivalent / (equivalent + reach - height)))


@kernel
def _send(launch, k, elevation, angle, band, half_width, law):
    """Set ray k: its elevation, the angle it stands for and the difference of sin(elevation) over that angle."""
    c, s = math.cos(elevation), math.sin(elevation)
    widest = cone_azimuth(c, half_width)
    place = (k + 1) * GOLDEN
    azimuth = widest * (2.0 * (place - math.floor(place)) - 1.0)
    launch.ahead[k], launch.abeam[k], launch.up[k] = c * math.sin(azimuth), c * math.cos(azimuth), s
    # Law `light` averages over the beam, law `sonar` integrates it.
    launch.weight[k] = angle if law == LIGHT or half_width <= 0.0 else band * 2.0 * widest


@kernel
def cone_azimuth(cos_elevation, half_width):
    """Greatest azimuth from athwart that a beam takes in at an elevation."""
    s = math.sin(half_width)
    return 0.5 * math.pi if cos_elevation <= s else math.asin(s / cos_elevation)


@kernel
def turn(launch, beam, bundle):
    """Turn all rays of a side from the sonar's axes to the world's."""
    for k in range(launch.up.size):
        bundle.x[k], bundle.y[k], bundle.z[k] = beam.x, beam.y, beam.z
        bundle.dx[k] = launch.ahead[k] * beam.ahead_x + launch.abeam[k] * beam.side_x
        bundle.dy[k] = launch.ahead[k] * beam.ahead_y + launch.abeam[k] * beam.side_y
        bundle.dz[k] = launch.up[k]


@kernel
def gather(solids, mesh, beam, near):
    """List the bodies that a beam can touch; return their number and the highest elevation of anything to be met."""
    count, top = 0, -0.5 * math.pi
    for k in range(solids.shape.size):
        middle = 0.5 * solids.length[k]
        cx = solids.start[k, 0] + middle * solids.axis[k, 0] - beam.x
        cy = solids.start[k, 1] + middle * solids.axis[k, 1] - beam.y
        cz = solids.start[k, 2] + middle * solids.axis[k, 2] - beam.z
        bound = middle + widest(solids, k)
        distance = math.sqrt(cx * cx + cy * cy + cz * cz)
        if not _touches(beam, cx, cy, distance, bound):
            continue
        near[count] = k
        count += 1
        summit = cz + middle * abs(solids.axis[k, 2]) + widest(solids, k)
        top = max(top, highest_elevation(summit, max(distance - bound, 0.0), min(distance + bound, beam.reach)))
    top = _highest_of_mesh(mesh, beam, top)
    # Rounded up, so that the aim serves many pings.
    return count, math.ceil(top * AIM_STEPS) / AIM_STEPS


@kernel
def _touches(beam, cx, cy, distance, bound):
    """Whether a beam can touch a ball, its centre counted from the sonar."""
    if abs(cx * beam.ahead_x + cy * beam.ahead_y) - bound > math.sin(beam.half_width) * (distance + bound):
        return False
    return cx * beam.side_x + cy * beam.side_y >= -bound and distance - bound <= beam.reach


@kernel
def _highest_of_mesh(mesh, beam, top):
    """Greatest elevation of the mesh's boxes in a beam, or ``top`` if that is more."""
    node = 0
    while node < mesh.skip.size:
        wx = 0.5 * (mesh.high[node, 0] - mesh.low[node, 0])
        wy = 0.5 * (mesh.high[node, 1] - mesh.low[node, 1])
        wz = 0.5 * (mesh.high[node, 2] - mesh.low[node, 2])
        cx, cy = mesh.low[node, 0] + wx - beam.x, mesh.low[node, 1] + wy - beam.y
        cz = mesh.low[node, 2] + wz - beam.z
        bound, distance = math.sqrt(wx * wx + wy * wy + wz * wz), math.sqrt(cx * cx + cy * cy + cz * cz)
        highest = top
        if _touches(beam, cx, cy, distance, bound):
            farthest = min(distance + bound, beam.reach)
            highest = highest_elevation(cz + wz, max(distance - bound, 0.0), farthest)
        if highest <= top:
            node = mesh.skip[node]
            continue
        if mesh.held[node] > 0:
            top = highest
        node += 1
    return top


@kernel
def highest_elevation(summit, nearest, farthest):
    """Greatest elevation of anything no higher than ``summit`` above the sonar and between two distances from it."""
    if summit < 0.0:
        return math.asin(max(summit / farthest, -1.0))
    return math.asin(summit / nearest) if summit < nearest else 0.5 * math.pi


@kernel
def inside_body(solids, x, y, z):
    """Row of the body that a point is inside, -1 if none."""
    for k in range(solids.shape.size):
        px, py, pz = x - solids.start[k, 0], y - solids.start[k, 1], z - solids.start[k, 2]
        ax, ay, az = solids.axis[k]
        along = px * ax + py * ay + pz * az
        if solids.shape[k] != SPHERE and not 0.0 <= along <= solids.length[k]:
            continue
        if px * px + py * py + pz * pz - along * along <= (solids.radius[k] + solids.taper[k] * along) ** 2:
            return k
    return -1
