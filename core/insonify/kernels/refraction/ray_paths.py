"""Whole rays through any water: points at given ground ranges, how each ray ends, and the caustics that it touches.

Theory: docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.refraction.arcs import ENDLESS, HIGH, LOW, NODE, RANGE, find_layer, follow_arc
from insonify.kernels.refraction.section_arcs import advance_ray, find_triangle, launch_ray, reflect_ray

STEPS = 100_000  # layers, triangles and reflections after which a ray counts as trapped
CAUSTIC_COLUMNS = 4  # of each caustic: number of the ray, range, height, time
AT_RANGE, ON_BED, AT_SURFACE, NOWHERE, TRAPPED = 0, 1, 2, 3, 4


class RayPoints(NamedTuple):
    """Points along rays, a row for each ray; NaN after a ray's last."""

    x: NDArray[np.float64]
    z: NDArray[np.float64]
    cosine: NDArray[np.float64]  # of the ray's direction above the horizontal
    sine: NDArray[np.float64]
    time: NDArray[np.float64]
    q: NDArray[np.float64]  # m/rad, signed as by `arcs.reflect_at_level`
    grazed: NDArray[np.bool_]  # whether q is capped
    turns: NDArray[np.int64]  # times the ray has turned in the water
    tops: NDArray[np.int64]  # reflections by the surface
    bottoms: NDArray[np.int64]  # reflections by the bed


class RayLimits(NamedTuple):
    """Where rays end, or are reflected."""

    x: float  # ground range at which they end, m
    low: float  # height of the bed, m
    high: float  # height of the sea surface, m
    from_bed: bool  # whether the bed reflects rays
    from_surface: bool  # whether the surface reflects rays


@kernel
def trace_ray_paths(water, plane, z0, angles, ranges, limits, points, ends):
    """Follow rays from one height at ground range 0.

    Parameters
    ----------
    water : Water
    plane : SectionPlane
        In which the rays run.
    z0 : float
        m.
    angles : ndarray, shape (n,)
        Of launch, above the horizontal, rad.
    ranges : ndarray, shape (m,)
        Where points are wanted, ascending, up to ``limits.x``, m.
    limits : RayLimits
    points : RayPoints of ndarrays, shape (n, m + 1)
        Filled, up to a ray's end: beyond its last range that is a point of its own.
    ends : ndarray of int64, shape (n,)
        Filled with how each ray ends: AT_RANGE, ON_BED, AT_SURFACE, NOWHERE (it gets no farther in range), or TRAPPED
        (it takes too many steps).
    """
    height, speed, station = water.height, water.speed, water.station
    for n in range(angles.size):
        steep = abs(angles[n]) >= 0.5 * math.pi
        cosine, sine = 0.0 if steep else math.cos(angles[n]), math.sin(angles[n])
        ray = launch_ray(height, speed, station, plane, z0, cosine, sine)
        count, turns, tops, bottoms, ends[n] = 0, 0, 0, 0, TRAPPED
        for _ in range(STEPS):
            if count < ranges.size and ray.x >= ranges[count]:
                _write_point(points, n, count, ray, turns, tops, bottoms)
                count += 1
                continue
            if ray.x >= limits.x:
                ends[n] = AT_RANGE
                break
            x_end = ranges[count] if count < ranges.size else limits.x
            sine = ray.sine
            status, ray = advance_ray(height, speed, station, plane, ray, x_end, limits.low, limits.high)
            if ray.sine * sine < 0.0:
                turns += 1
            if status == NODE or status == RANGE:
                continue
            if (status == LOW and limits.from_bed) or (status == HIGH and limits.from_surface):
                tops, bottoms = tops + (status == HIGH), bottoms + (status == LOW)
                ray = reflect_ray(height, speed, station, plane, ray)
                continue
            ends[n] = NOWHERE
            if status == LOW or status == HIGH:
                ends[n] = ON_BED if status == LOW else AT_SURFACE
                _write_point(points, n, count, ray, turns, tops, bottoms)
            break


@inlined
def _write_point(points, n, k, ray, turns, tops, bottoms):
    """Write one point of a ray."""
    points.x[n, k], points.z[n, k], points.cosine[n, k], points.sine[n, k] = ray.x, ray.z, ray.cosine, ray.sine
    points.time[n, k], points.q[n, k], points.grazed[n, k] = ray.time, ray.q, ray.grazed
    points.turns[n, k], points.tops[n, k], points.bottoms[n, k] = turns, tops, bottoms


@kernel
def trace_caustics(water, plane, z0, angles, limits, found):
    """Places where rays from one height at ground range 0 touch caustics; parameters as of `trace_ray_paths`."""
    # Rows of ``found`` (m, CAUSTIC_COLUMNS) are filled from its beginning. Returns the number of caustics, m if there
    # may be more than there is room for.
    height, speed, station = water.height, water.speed, water.station
    count = 0
    for n in range(angles.size):
        steep = abs(angles[n]) >= 0.5 * math.pi
        cosine, sine = 0.0 if steep else math.cos(angles[n]), math.sin(angles[n])
        ray = launch_ray(height, speed, station, plane, z0, cosine, sine)
        for _ in range(STEPS):
            before = ray
            status, ray = advance_ray(height, speed, station, plane, ray, limits.x, limits.low, limits.high)
            if before.q * ray.q < 0.0:
                if count == found.shape[0]:
                    return count
                there = _reach_caustic(height, speed, station, plane, before)
                found[count, 0], found[count, 1], found[count, 2], found[count, 3] = n, there.x, there.z, there.time
                count += 1
            if (status == LOW and limits.from_bed) or (status == HIGH and limits.from_surface):
                ray = reflect_ray(height, speed, station, plane, ray)
            elif status == RANGE or status == ENDLESS or status == LOW or status == HIGH:
                break
    return count


@inlined
def _reach_caustic(height, speed, station, plane, ray):
    """Ray where its q is 0, within the arc that begins here."""
    if station.size == 1:
        _, gz, _, _ = find_layer(height, speed[0], ray)
        gx = 0.0
    else:
        _, _, piece = find_triangle(height, speed, station, plane, ray)
        gx, gz = piece.along * plane.along, piece.up
    # ∫c ds = -q/p from here, and in terms of the tangents (c + g·u T/2) T / (1 + κ²T²/4): a quadratic in T.
    needed = -ray.q / ray.p
    bend = (ray.cosine * gz - ray.sine * gx) / ray.speed
    square = 0.5 * (ray.cosine * gx + ray.sine * gz) - 0.25 * needed * bend * bend
    tangents = 2.0 * needed / (ray.speed + math.sqrt(ray.speed * ray.speed + 4.0 * needed * square))
    return follow_arc(ray, gx, gz, tangents)
