"""Paths of sound from the sonar to a place and back: straight, bent, or by the sea surface, as lines of points."""

import math
from dataclasses import dataclass

import numpy as np

from insonify.acoustics.rays import follow_paths
from insonify.arrays import Floats
from insonify.kernels.common.types import PORT, Poses, SceneArrays
from insonify.kernels.refraction.ray_paths import RayLimits
from insonify.kernels.refraction.section_arcs import SectionPlane
from insonify.simulation import Simulation
from insonify.tracers.labels import PATHS

POINTS = 48  # along a bent ray
HALVINGS = 40  # that find the height of a place from its slant range
DIRECT = PATHS.index("direct")
SURFACE_BOTTOM_SURFACE = PATHS.index("surface_bottom_surface")
SECOND_BOTTOM, SURFACE = PATHS.index("second_bottom"), PATHS.index("surface")


@dataclass(frozen=True, eq=False)
class SonarPose:
    """The sonar at one ping, and one of its sides."""

    place: Floats  # (3,) local coordinates, height above the datum, m
    ahead: Floats  # (2,) level unit vector of the heading
    abeam: Floats  # (2,) level unit vector to the side
    surface: float  # heights of the sea surface and of the bed beneath the sonar, m
    below: float

    def direction(self, azimuth: float) -> Floats:
        """Level unit vector of an azimuth from athwart towards the bow, rad."""
        return np.asarray(math.sin(azimuth) * self.ahead + math.cos(azimuth) * self.abeam)

    def to_world(self, azimuth: float, flat: Floats) -> Floats:
        """Local coordinates of places in the plane of an azimuth: (n, 2) ground range and height to (n, 3)."""
        level = self.place[:2] + np.multiply.outer(flat[:, 0], self.direction(azimuth))
        return np.column_stack([level, flat[:, 1]])


def locate_sonar(simulation: Simulation, pose: Poses, side: int) -> SonarPose:
    """Place the sonar of one ping."""
    cos, sin = math.cos(float(pose.heading[0])), math.sin(float(pose.heading[0]))
    turn = 1.0 if side == PORT else -1.0
    below = float(simulation.ground.height_at(pose.x, pose.y)[0])
    return SonarPose(
        place=np.array([float(pose.x[0]), float(pose.y[0]), float(pose.z[0])]),
        ahead=np.array([cos, sin]),
        abeam=turn * np.array([-sin, cos]),
        surface=float(simulation.arrays.water.surface),
        below=below,
    )


def trace_path(
    arrays: SceneArrays, sonar: SonarPose, path: int, azimuth: float, launch: float, place: Floats
) -> Floats:
    """Path of the sound out and back in the plane of an azimuth."""
    start = np.array([0.0, sonar.place[2]])
    if path == SURFACE:
        return np.array([start, [0.0, sonar.surface], start])
    if path == DIRECT:
        if arrays.water.bent and math.isfinite(launch):
            return _bent_ray(arrays, sonar, azimuth, launch, place)
        return np.array([start, place])
    back = _by_images(sonar, path, place)
    out = back[::-1] if path == SURFACE_BOTTOM_SURFACE else start[None]
    return np.concatenate([out, place[None], back])


def _by_images(sonar: SonarPose, path: int, place: Floats) -> Floats:
    """Points between a place and the sonar by way of the sea surface, and of the bed beneath the sonar."""
    start, up = np.array([0.0, sonar.place[2]]), sonar.surface - sonar.place[2]
    if path != SECOND_BOTTOM:
        image = np.array([0.0, sonar.surface + up])
        return np.array([_crossing(place, image, sonar.surface), start])
    # The image of the sonar in the bed beneath it, mirrored in the surface.
    bottom = 2.0 * sonar.surface - sonar.below
    image = np.array([0.0, 2.0 * sonar.surface - (2.0 * sonar.below - sonar.place[2])])
    at_bed = _crossing(place, image, bottom)
    return np.array([_crossing(place, image, sonar.surface), [at_bed[0], sonar.below], start])


def _crossing(place: Floats, image: Floats, height: float) -> Floats:
    """Point at a height of the straight line from a place to an image of the sonar."""
    share = (height - place[1]) / (image[1] - place[1])
    return np.asarray(place + share * (image - place))


def _bent_ray(arrays: SceneArrays, sonar: SonarPose, azimuth: float, launch: float, place: Floats) -> Floats:
    """Ray through the water by its launch angle, out to the ground range of a place."""
    water, ex = arrays.water, sonar.direction(azimuth)
    ranges = np.linspace(0.0, max(float(place[0]), 1e-3), POINTS + 1)[1:]
    along = SectionPlane(
        float(sonar.place[0] * water.axis_x + sonar.place[1] * water.axis_y),
        float(ex[0] * water.axis_x + ex[1] * water.axis_y),
    )
    limits = RayLimits(float(ranges[-1]), -math.inf, sonar.surface, False, False)
    points, _ = follow_paths(water, float(sonar.place[2]), np.array([launch]), ranges, limits, along)
    followed = np.column_stack([points.x[0], points.z[0]])
    followed = followed[np.isfinite(followed).all(axis=1)]
    return np.concatenate([[[0.0, sonar.place[2]]], followed, place[None]])


def height_by_range(sonar: SonarPose, path: int, ground_range: float, slant_range: float, low: float) -> float:
    """Height at which an echo by way of the sea surface has a slant range, at a ground range."""
    bottom, top = low, float(sonar.place[2])
    for _ in range(HALVINGS):
        middle = 0.5 * (bottom + top)
        farther = path_range(sonar, path, ground_range, middle) > slant_range
        bottom, top = (middle, top) if farther else (bottom, middle)
    return 0.5 * (bottom + top)


def path_range(sonar: SonarPose, path: int, ground_range: float, height: float) -> float:
    """Slant range of an echo by way of the sea surface: half the path by both images of the sonar."""
    up, rise = sonar.surface - float(sonar.place[2]), height - float(sonar.place[2])
    images = {SURFACE_BOTTOM_SURFACE: (2.0 * up, 2.0 * up), SECOND_BOTTOM: (0.0, 2.0 * (sonar.surface - sonar.below))}
    one, other = images.get(path, (0.0, 2.0 * up))
    return 0.5 * (math.hypot(ground_range, rise - one) + math.hypot(ground_range, rise - other))
