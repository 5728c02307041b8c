"""Tracing of ray diagrams: rays, shadow zones, caustics and eigenrays in the water of a scene."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.rays import follow_paths, join_points
from insonify.acoustics.water import make_sound_speed_field, make_water
from insonify.display.ray_diagram.diagram import DiagramEigenray, DiagramRay, RayDiagram
from insonify.display.ray_diagram.ray_fan import RayFan, trace_fan
from insonify.kernels.common.types import Water
from insonify.kernels.refraction.eigenray_search import ANGLE, TIME, TUBE
from insonify.kernels.refraction.ray_paths import RayLimits
from insonify.scene import Scene, SceneError

Values = NDArray[np.float64]
ACROSS = 480  # columns of the shadow's picture, along the range
POINTS = 241  # of each ray
STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)  # degrees from ray to ray
MOST_RAYS = 50
FARTHEST = 1e6  # m; on Earth, rounder farther out than a plane section
NEAREST_HIT = 0.25  # share of the range at which the steepest ray that is drawn meets the bed or the surface


def trace_ray_diagram(
    scene: Scene, *, datum: float | None = None, target: tuple[float, float] | None = None, columns: int = ACROSS
) -> RayDiagram:
    """Trace the ray diagram of a scene's water."""
    datum = -scene.seabed.depth if datum is None else datum
    water, bottom = make_water(scene, datum), -datum
    depth = bottom - scene.altitude if scene.track.depth is None else scene.track.depth
    if not 0.0 <= depth < bottom:
        raise SceneError(f"track: the sonar at {depth:g} m is not in water {bottom:g} m deep; change its depth")
    if target is not None and not (0.0 < target[0] <= FARTHEST and 0.0 <= target[1] <= bottom):
        raise SceneError(
            f"target: {target[0]:g} m away and {target[1]:g} m deep is no point of the water; give a range above 0, "
            f"to {FARTHEST:g} m, and a depth from 0 to {bottom:g} m"
        )
    reach = scene.sonar.range if target is None else max(scene.sonar.range, 1.05 * target[0])
    limits = RayLimits(reach, 0.0, bottom, False, False)
    fan = trace_fan(water, bottom - depth, limits, columns)
    return RayDiagram(
        title=scene.title,
        layers=make_sound_speed_field(scene.water),
        source_depth=depth,
        bottom=bottom,
        reach=reach,
        rays=_paths(water, bottom, depth, _round_angles(depth, bottom, reach), limits),
        shadow=~fan.lit[::-1],
        dark=fan.dark,
        caustics=_caustics(fan, bottom),
        target=target,
        eigenrays=() if target is None else _eigenrays(water, bottom, depth, target),
    )


def _round_angles(depth: float, bottom: float, reach: float) -> Values:
    """Round launch angles in degrees below the horizontal, 0 included, at most `MOST_RAYS`."""
    steepest = math.degrees(math.atan2(max(depth, bottom - depth), NEAREST_HIT * reach))
    step = next((step for step in STEPS if 2.0 * steepest / step <= MOST_RAYS), STEPS[-1])
    count = math.ceil(min(steepest, 85.0) / step)
    return np.arange(-count, count + 1, dtype=np.float64) * step


def _paths(water: Water, bottom: float, depth: float, angles: Values, limits: RayLimits) -> tuple[DiagramRay, ...]:
    """Trace rays to their ends; the sonar is their first point."""
    ranges = np.linspace(0.0, limits.x, POINTS)
    points, _ = follow_paths(water, bottom - depth, -np.radians(angles), ranges, limits)
    there = np.isfinite(points.x)
    return tuple(
        DiagramRay(float(angle), x[real], bottom - z[real], time[real])
        for angle, x, z, time, real in zip(angles, points.x, points.z, points.time, there)
    )


def _eigenrays(water: Water, bottom: float, depth: float, target: tuple[float, float]) -> tuple[DiagramEigenray, ...]:
    x, z = target[0], bottom - target[1]
    rows = join_points(water, bottom - depth, z, x, 0.0, bottom, 0)
    found = []
    for row in rows:
        angle = -math.degrees(float(row[ANGLE]))
        spread = x * abs(float(row[TUBE]))
        level = 10.0 * math.log10(math.cos(float(row[ANGLE])) / spread) if spread > 0.0 else math.inf
        # The last point is the target itself, whatever rounding makes of a ray that touches the bed there.
        (path,) = _paths(water, bottom, depth, np.array([angle]), RayLimits(x, 0.0, bottom, False, False))
        time = float(row[TIME])
        points = (np.append(path.range[:-1], x), np.append(path.depth[:-1], target[1]), np.append(path.time[:-1], time))
        found.append(DiagramEigenray(angle, *points, time, water.reference * time, level))
    return tuple(found[::-1])


def _caustics(fan: RayFan, bottom: float) -> Values:
    """Points at which the tube of a ray changes sign between two points of the ray."""
    with np.errstate(invalid="ignore"):
        closes = fan.tube[:, 1:-1] * fan.tube[:, 2:] < 0.0
    ray, column = np.nonzero(closes)
    before, after = fan.tube[ray, column + 1], fan.tube[ray, column + 2]
    share = before / (before - after)
    low, high = fan.height[ray, column + 1], fan.height[ray, column + 2]
    x = fan.ranges[column + 1] + share * (fan.ranges[column + 2] - fan.ranges[column + 1])
    return np.column_stack([x, bottom - (low + share * (high - low))])
