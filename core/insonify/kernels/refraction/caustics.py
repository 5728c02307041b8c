"""Caustics: places at which the tube of a ray has no width.

Theory: docs/theory/refraction.md.
"""

from __future__ import annotations

import math

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.refraction.arcs import ENDLESS, HIGH, LOW, RANGE, find_layer, follow_arc
from insonify.kernels.refraction.ray_paths import STEPS
from insonify.kernels.refraction.section_arcs import advance_ray, find_triangle, launch_ray, reflect_ray

COLUMNS = 4  # of each caustic: number of the ray, range, height, time


@kernel
def trace_caustics(water, plane, z0, angles, limits, found):
    """Places at which rays from one height at ground range 0 touch caustics.

    Parameters
    ----------
    water, plane, z0, angles, limits
        As in `ray_paths.trace_ray_paths`.
    found : ndarray, shape (m, COLUMNS)
        Filled from its beginning.

    Returns
    -------
    int
        Caustics found; m if there may be more than there is room for.
    """
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
