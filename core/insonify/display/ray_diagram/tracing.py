"""Tracing of ray diagrams: rays, shadow zones, caustics and eigenrays, by single rays and by a dense fan of rays."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.rays import follow_paths, join_points
from insonify.acoustics.water import make_sound_speed_field, make_water
from insonify.arrays import Booleans, Floats, Integers
from insonify.display.ray_diagram.diagram import DiagramEigenray, DiagramRay, RayDiagram
from insonify.kernels.common.types import Water
from insonify.kernels.refraction.eigenray_search import ANGLE, TIME, TUBE
from insonify.kernels.refraction.ray_paths import AT_SURFACE, ON_BED, RayLimits
from insonify.scene import Scene, SceneError

ACROSS = 480  # columns of the shadow's picture, along the range
POINTS = 241  # of each ray
ANGLE_STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)  # degrees from ray to ray
MOST_RAYS = 50
FARTHEST_RANGE = 1e6  # m; beyond, the curvature of the Earth matters
NEAREST_HIT = 0.25  # share of the range at which the steepest ray that is drawn meets the bed or the surface
FIRST = 257  # rays, denser towards the horizontal
MOST_EIGENRAYS = 4000
SEAM = 2e-3  # share of the range: a shorter gap between two rays, or under the sonar, counts as reached
ROUNDS = 40  # of refinement between rays that diverge
CELLS = 720  # of depth
WIDE = 12.0  # greatest distance of neighbours, in cells
ONE = 1e-12  # rad; rays launched closer than this that still diverge leave a shadow between them


def trace_ray_diagram(
    scene: Scene, *, datum: float | None = None, target: tuple[float, float] | None = None, columns: int = ACROSS
) -> RayDiagram:
    """Trace the ray diagram of a scene's water."""
    datum = -scene.seabed.depth if datum is None else datum
    water, bottom = make_water(scene, datum), -datum
    depth = bottom - scene.altitude if scene.track.depth is None else scene.track.depth
    if not 0.0 <= depth < bottom:
        raise SceneError(f"track: the sonar at {depth:g} m is not in water {bottom:g} m deep; change its depth")
    if target is not None and not (0.0 < target[0] <= FARTHEST_RANGE and 0.0 <= target[1] <= bottom):
        raise SceneError(
            f"target: {target[0]:g} m away and {target[1]:g} m deep is not in the water; give a range above 0, "
            f"to {FARTHEST_RANGE:g} m, and a depth from 0 to {bottom:g} m"
        )
    reach = scene.sonar.range if target is None else max(scene.sonar.range, 1.05 * target[0])
    limits = RayLimits(reach, 0.0, bottom, False, False)
    ranges = np.linspace(0.0, reach, columns)
    fan = _trace_fan(water, bottom - depth, limits, ranges)
    # Round launch angles, 0 included, at most `MOST_RAYS`.
    steepest = math.degrees(math.atan2(max(depth, bottom - depth), NEAREST_HIT * reach))
    step = next((step for step in ANGLE_STEPS if 2.0 * steepest / step <= MOST_RAYS), ANGLE_STEPS[-1])
    count = math.ceil(min(steepest, 85.0) / step)
    angles = np.arange(-count, count + 1, dtype=np.float64) * step
    return RayDiagram(
        title=scene.title,
        layers=make_sound_speed_field(scene.water),
        source_depth=depth,
        bottom=bottom,
        reach=reach,
        rays=_paths(water, bottom, depth, angles, limits),
        shadow=~_lit(fan, limits)[::-1],
        dark=_dark(fan, reach),
        caustics=_caustics(fan, ranges, bottom),
        target=target,
        eigenrays=() if target is None else _eigenrays(water, bottom, depth, target),
        limits=(*scene.water.remarks(), *scene.describe_limits()),
    )


def _paths(water: Water, bottom: float, depth: float, angles: Floats, limits: RayLimits) -> tuple[DiagramRay, ...]:
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
        # The last point is set to the target, because rounding may move the end of a ray that touches the bed there.
        (path,) = _paths(water, bottom, depth, np.array([angle]), RayLimits(x, 0.0, bottom, False, False))
        time = float(row[TIME])
        points = (np.append(path.range[:-1], x), np.append(path.depth[:-1], target[1]), np.append(path.time[:-1], time))
        found.append(DiagramEigenray(angle, *points, time, water.reference * time, level))
    return tuple(found[::-1])


def _caustics(fan: _Rays, ranges: Floats, bottom: float) -> Floats:
    """Points at which the tube of a ray changes sign between two points of the ray."""
    with np.errstate(invalid="ignore"):
        closes = fan.tube[:, 1:-1] * fan.tube[:, 2:] < 0.0
    ray, column = np.nonzero(closes)
    before, after = fan.tube[ray, column + 1], fan.tube[ray, column + 2]
    share = before / (before - after)
    low, high = fan.height[ray, column + 1], fan.height[ray, column + 2]
    x = ranges[column + 1] + share * (ranges[column + 2] - ranges[column + 1])
    return np.column_stack([x, bottom - (low + share * (high - low))])


class _Rays(NamedTuple):
    """Heights and tubes of a fan of rays by launch angle and range, NaN after the end of each ray."""

    angle: Floats  # (n,) of launch, rad
    height: Floats  # (n, m) in metres
    tube: Floats  # (n, m) q in m/rad
    last: Floats  # (n,) range at which it ends, m
    end: Integers  # (n,)


def _trace_fan(water: Water, height: float, limits: RayLimits, ranges: Floats) -> _Rays:
    """Trace a fan of rays in all directions, by launch angle, refined where neighbours diverge."""
    places = np.linspace(-1.0, 1.0, FIRST)
    rays = _trace(water, height, 0.4999 * math.pi * places * np.abs(places), ranges, limits)
    kept, count, cell = [rays], FIRST, (limits.high - limits.low) / CELLS
    first, last = _taken(rays, slice(None, -1)), _taken(rays, slice(1, None))
    for _ in range(ROUNDS):
        # Neighbours that diverge by more than some cells or end differently.
        with np.errstate(invalid="ignore"):
            far = (np.abs(first.height - last.height) > WIDE * cell).any(axis=1)
        parted = (far | (first.end != last.end)) & (last.angle - first.angle > ONE)
        first, last = _taken(first, parted), _taken(last, parted)
        count += first.angle.size
        if first.angle.size == 0 or count > MOST_EIGENRAYS:
            break
        middle = _trace(water, height, 0.5 * (first.angle + last.angle), ranges, limits)
        kept.append(middle)
        first, last = _joined([first, middle]), _joined([middle, last])
    rays = _joined(kept)
    return _taken(rays, np.argsort(rays.angle, kind="stable"))


def _trace(water: Water, height: float, angles: Floats, ranges: Floats, limits: RayLimits) -> _Rays:
    points, ends = follow_paths(water, height, angles, ranges, limits)
    # Each row has one more point, where the ray ends; ranges beyond it are unused.
    beyond = points.x[:, : ranges.size] != ranges
    z, q = points.z[:, : ranges.size], points.q[:, : ranges.size]
    z[beyond], q[beyond] = np.nan, np.nan
    return _Rays(angles, z, q, np.fmax.reduce(points.x, axis=1), ends)


def _taken(rays: _Rays, which: slice | NDArray[Any]) -> _Rays:
    columns: Any = (column[which] for column in rays)
    return _Rays(*columns)


def _joined(parts: list[_Rays]) -> _Rays:
    return _Rays(*(np.concatenate(columns) for columns in zip(*parts)))


def _dark(rays: _Rays, reach: float) -> Floats:
    """Stretches of range in which no pair of neighbours meets the bed."""
    both = (rays.end[:-1] == ON_BED) & (rays.end[1:] == ON_BED) & (np.diff(rays.angle) > ONE)
    ends = np.sort(np.stack([rays.last[:-1][both], rays.last[1:][both]], axis=1), axis=1)
    ends = ends[np.argsort(ends[:, 0])]
    reached = np.maximum.accumulate(np.append(0.0, ends[:, 1]))
    begins = np.append(ends[:, 0], reach)
    gaps = begins > reached + SEAM * reach
    return np.column_stack([reached[gaps], begins[gaps]])


def _lit(rays: _Rays, limits: RayLimits) -> Booleans:
    """Cells between neighbours, lowest first; two that end on the bed or at the surface enclose the cells up to it."""
    height, ends, cell = rays.height, rays.end, (limits.high - limits.low) / CELLS
    first, last = height[:-1], height[1:]
    for code, level in ((ON_BED, limits.low), (AT_SURFACE, limits.high)):
        both = ((ends[:-1] == code) & (ends[1:] == code))[:, None]
        one, other = np.isnan(first), np.isnan(last)
        first = np.where(both & one & ~other, level, first)
        last = np.where(both & other & ~one, level, last)
    between = np.isfinite(first) & np.isfinite(last)
    torn = (np.diff(rays.angle) <= ONE)[:, None] & (np.abs(first - last) > WIDE * cell)
    pair, column = np.nonzero(between & ~torn)
    low, high = np.sort(np.stack([first[pair, column], last[pair, column]]), axis=0)
    columns = height.shape[1]
    begin = np.clip(np.floor((low - limits.low) / cell).astype(np.int64), 0, CELLS - 1)
    end = np.clip(np.ceil((high - limits.low) / cell).astype(np.int64), begin + 1, CELLS)
    size = (CELLS + 1) * columns
    changes = np.bincount(begin * columns + column, minlength=size) - np.bincount(
        end * columns + column, minlength=size
    )
    lit = np.cumsum(changes.reshape(CELLS + 1, columns), axis=0)[:-1] > 0
    lit[:, 0] = True  # by the vertical rays
    return lit
