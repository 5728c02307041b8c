"""Launch directions of straight rays, and the angle that each stands for.

On a level bed the rays of the main stratum hit at equal steps of slant range; a second stratum takes the elevations
above it, up to the highest thing there is to see. Across a beam azimuths follow the golden ratio. Rays of a level
top-hat lie over the exact width of the cone |sin φ_b| = cos θ |sin φ| <= sin(w/2) at each elevation. Rays of any other
beam lie half evenly over the azimuths in the beam, half in proportion to the pattern. The beam as a cone is derived in
docs/theory/beam.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.beam.pattern import pick_azimuth, widest_extent
from insonify.kernels.bed.slice import snap_to_grid
from insonify.kernels.common.types import LIGHT, PORT
from insonify.kernels.geometry.solids import greatest_radius

AIM_STEPS = 64.0  # steps per radian to which the highest elevation is rounded up
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class SideBeam(NamedTuple):
    """Place, axes and extent of the beam of one side of one ping."""

    x: float
    y: float
    z: float
    ahead_x: float  # level unit vector of the heading
    ahead_y: float
    side_x: float  # level unit vector at right angles to it, towards the side
    side_y: float
    axis_x: float  # unit vector about which the beam's cones lie: the fish's own, or the heading of a level beam
    axis_y: float
    axis_z: float
    s_low: float  # sines of the angles from the plane athwart it between which the beam responds
    s_high: float
    own_x: float  # unit vector towards the side, of the pitched and rolled fish
    own_y: float
    own_z: float
    up_x: float  # unit vector upwards, of the pitched and rolled fish
    up_y: float
    up_z: float
    reach: float  # m


class RayLaunch(NamedTuple):
    """Directions of the rays of one side in the sonar's own axes, and the weight of each."""

    ahead: NDArray[np.float64]  # (n,) unit directions
    abeam: NDArray[np.float64]  # (n,)
    up: NDArray[np.float64]  # (n,)
    weight: NDArray[np.float64]  # (n,) rad (knife, top-hat of law `light`), sr (law `sonar`), rad² (a pattern's light)


@kernel
def empty_launch(n):
    """Room for the directions of n rays."""
    return RayLaunch(np.empty(n), np.empty(n), np.empty(n), np.empty(n))


@inlined
def orient_beam(arrays, poses, ping, side):
    """Axes of the beam of one side of one ping, after heading, pitch (bow up), then roll (port up)."""
    ahead_x, ahead_y = snap_to_grid(math.cos(poses.heading[ping])), snap_to_grid(math.sin(poses.heading[ping]))
    to_side = 1.0 if side == PORT else -1.0
    x, y, z, reach = poses.x[ping], poses.y[ping], poses.z[ping], arrays.bins * arrays.bin_length
    if not arrays.pattern.tabulated:
        s = math.sin(arrays.half_width)
        return SideBeam(
            x, y, z, ahead_x, ahead_y, -to_side * ahead_y, to_side * ahead_x, ahead_x, ahead_y, 0.0, -s, s,
            -to_side * ahead_y, to_side * ahead_x, 0.0, 0.0, 0.0, 1.0, reach,
        )  # fmt: skip
    cos_p, sin_p = math.cos(poses.pitch[ping]), math.sin(poses.pitch[ping])
    cos_r, sin_r = math.cos(poses.roll[ping]), math.sin(poses.roll[ping])
    level_up_x, level_up_y = -sin_p * ahead_x, -sin_p * ahead_y
    own_x, own_y = -cos_r * ahead_y + sin_r * level_up_x, cos_r * ahead_x + sin_r * level_up_y
    up_x, up_y = cos_r * level_up_x + sin_r * ahead_y, cos_r * level_up_y - sin_r * ahead_x
    axis_x, axis_y, axis_z, s_low, s_high = ahead_x, ahead_y, 0.0, 0.0, 0.0
    if arrays.half_width > 0.0:
        extent = widest_extent(arrays.pattern)
        s_low, s_high = arrays.pattern.centre - extent, arrays.pattern.centre + extent
        axis_x, axis_y, axis_z = cos_p * ahead_x, cos_p * ahead_y, sin_p
    return SideBeam(
        x, y, z, ahead_x, ahead_y, -to_side * ahead_y, to_side * ahead_x, axis_x, axis_y, axis_z, s_low, s_high,
        to_side * own_x, to_side * own_y, to_side * sin_r * cos_p, up_x, up_y, cos_r * cos_p, reach,
    )  # fmt: skip


@kernel
def aim_rays(launch, height, top, reach, half_width, law, spreads):
    """Aim all rays of a side: equal steps of slant range on a level bed, then elevations up to ``top``, rad."""
    # A beam pattern that spreads the rays over azimuths does so afterwards: then they are aimed athwart.
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
        set_ray(launch, k, -theta, angle, height / r_near - height / r_far, half_width, law, spreads)
    step = (top - lowest) / max(n - main, 1)
    for k in range(main, n):
        low = lowest + (k - main) * step
        band = math.sin(low + step) - math.sin(low)
        set_ray(launch, k, low + 0.5 * step, step, band, half_width, law, spreads)


@kernel
def _upper_rays(n, height, reach, lowest, top):
    """Count the rays above the level bed: as dense as the last of the main stratum, at most half of all."""
    if top <= lowest:
        return 0
    # dr/dθ of a level bed at the end of the range turns the angle into metres of slant range.
    equivalent = (top - lowest) * reach * math.sqrt(reach * reach - height * height) / height
    return min(n // 2, math.ceil(n * equivalent / (equivalent + reach - height)))


@kernel
def set_ray(launch, k, elevation, angle, band, half_width, law, spreads):
    """Set the direction and the weight of one ray."""
    c, s = math.cos(elevation), math.sin(elevation)
    # Law `light` averages over the beam, law `sonar` integrates it.
    weight = angle if law == LIGHT or half_width <= 0.0 else band
    azimuth = 0.0
    if not spreads:
        widest = cone_azimuth(c, half_width)
        azimuth = widest * (2.0 * _place_in_beam(k) - 1.0)
        if law != LIGHT and half_width > 0.0:
            weight *= 2.0 * widest
    launch.ahead[k], launch.abeam[k], launch.up[k] = c * math.sin(azimuth), c * math.cos(azimuth), s
    launch.weight[k] = weight


@inlined
def _place_in_beam(k):
    """Place of ray k across the beam, in [0, 1): multiples of the golden ratio."""
    place = (k + 1) * GOLDEN
    return place - math.floor(place)


@kernel
def spread_over_pattern(launch, pattern, height, reach, pitch):
    """Spread rays that lie athwart over the azimuths of a beam pattern."""
    for k in range(launch.up.size):
        c, s = launch.abeam[k], launch.up[k]
        # Slant range at which the ray meets a level bed, or the end of the range.
        r = min(-height / s, reach) if s < 0.0 < height else reach
        azimuth, stands_for = pick_azimuth(pattern, math.cos(pitch) * c, math.sin(pitch) * s, r, _place_in_beam(k))
        launch.ahead[k], launch.abeam[k] = c * math.sin(azimuth), c * math.cos(azimuth)
        launch.weight[k] *= stands_for


@kernel
def cone_azimuth(cos_elevation, half_width):
    """Greatest azimuth from athwart that a fan takes in at an elevation."""
    s = math.sin(half_width)
    return 0.5 * math.pi if cos_elevation <= s else math.asin(s / cos_elevation)


@kernel
def rotate_to_world(launch, beam, bundle):
    """Fill a bundle with the rays of a side, turned from the sonar's axes to the world's."""
    for k in range(launch.up.size):
        bundle.x[k], bundle.y[k], bundle.z[k] = beam.x, beam.y, beam.z
        bundle.dx[k] = launch.ahead[k] * beam.ahead_x + launch.abeam[k] * beam.side_x
        bundle.dy[k] = launch.ahead[k] * beam.ahead_y + launch.abeam[k] * beam.side_y
        bundle.dz[k] = launch.up[k]


@kernel
def list_solids_in_beam(solids, mesh, beam, near):
    """List the solids that a beam can touch; return their number, and the highest elevation of a target, rad."""
    count, top = 0, -0.5 * math.pi
    for k in range(solids.shape.size):
        middle, radius, cx, cy, cz = ball_about(solids, k)
        cx, cy, cz, bound = cx - beam.x, cy - beam.y, cz - beam.z, middle + radius
        distance = math.sqrt(cx * cx + cy * cy + cz * cz)
        if not beam_touches_ball(beam, cx, cy, cz, distance, bound):
            continue
        near[count] = k
        count += 1
        summit = cz + middle * abs(solids.axis[k, 2]) + radius
        top = max(top, highest_elevation(summit, max(distance - bound, 0.0), min(distance + bound, beam.reach)))
    top = _highest_of_mesh(mesh, beam, top)
    # Rounded up, so that the aim serves many pings.
    return count, math.ceil(top * AIM_STEPS) / AIM_STEPS


@inlined
def ball_about(solids, k):
    """Half the length of a solid, its greatest radius, and its middle: both lengths together bound it."""
    middle = 0.5 * solids.length[k]
    cx = solids.start[k, 0] + middle * solids.axis[k, 0]
    cy = solids.start[k, 1] + middle * solids.axis[k, 1]
    cz = solids.start[k, 2] + middle * solids.axis[k, 2]
    return middle, greatest_radius(solids, k), cx, cy, cz


@inlined
def box_about(mesh, node):
    """Half the lengths of the edges of a node's box, and its middle."""
    low, high = mesh.low[node], mesh.high[node]
    wx, wy, wz = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2])
    return wx, wy, wz, low[0] + wx, low[1] + wy, low[2] + wz


@inlined
def beam_touches_ball(beam, cx, cy, cz, distance, bound):
    """Whether a beam can touch a ball."""
    along = cx * beam.axis_x + cy * beam.axis_y + cz * beam.axis_z
    if along - bound > beam.s_high * (distance + math.copysign(bound, beam.s_high)):
        return False
    if along + bound < beam.s_low * (distance - math.copysign(bound, beam.s_low)):
        return False
    return cx * beam.side_x + cy * beam.side_y >= -bound and distance - bound <= beam.reach


@kernel
def _highest_of_mesh(mesh, beam, top):
    """Greatest elevation of the mesh's boxes in a beam, or ``top`` if that is more, rad."""
    node = 0
    while node < mesh.skip.size:
        wx, wy, wz, cx, cy, cz = box_about(mesh, node)
        cx, cy, cz = cx - beam.x, cy - beam.y, cz - beam.z
        bound, distance = math.sqrt(wx * wx + wy * wy + wz * wz), math.sqrt(cx * cx + cy * cy + cz * cz)
        highest = top
        if beam_touches_ball(beam, cx, cy, cz, distance, bound):
            farthest = min(distance + bound, beam.reach)
            highest = highest_elevation(cz + wz, max(distance - bound, 0.0), farthest)
        if highest <= top:
            node = mesh.skip[node]
            continue
        if mesh.leaf_size[node] > 0:
            top = highest
        node += 1
    return top


@kernel
def highest_elevation(summit, nearest, farthest):
    """Greatest elevation of anything no higher above the sonar than ``summit`` and between two distances, rad."""
    if summit < 0.0:
        return math.asin(max(summit / farthest, -1.0))
    return math.asin(summit / nearest) if summit < nearest else 0.5 * math.pi
