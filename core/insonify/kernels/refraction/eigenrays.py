"""The direct ray that joins two points of layered water, without reflections."""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.refraction import arcs

FOUND, NONE = 0, 1
STEPS = 10_000  # layers that a direct ray may pass; a trapped one ends there
TRIES = 200  # rays per root: halvings of a bracket, at worst
CLOSE = 1e-12  # accepted miss, as a share of the lengths involved


class DirectRay(NamedTuple):
    """A ray from one point to another: directions at both ends, travel time and spreading."""

    cosine0: float  # of its direction above the horizontal where it starts
    sine0: float
    time: float  # s
    cosine: float  # of its direction where it ends
    sine: float
    q: float  # distance across the ray per launch angle, m/rad; not positive if there are other rays, or beyond them


@kernel
def find_direct_ray(height, speed, z_from, z_to, x, low, high):
    """Direct ray between two points of layered water."""
    if x <= 0.0:
        return _vertical_ray(height, speed, z_from, z_to)
    slope = _guess_slope(height, speed, z_from, z_to, x)
    least, most = -math.inf, math.inf
    near = CLOSE * (x + abs(z_from) + abs(z_to))
    for _ in range(TRIES):
        cosine = 1.0 / math.sqrt(1.0 + slope * slope)
        status, ray = follow_to_range(
            height, speed, arcs.launch_in_layers(height, speed, z_from, cosine, slope * cosine), x, low, high
        )
        miss = ray.z - z_to
        if status == arcs.RANGE and abs(miss) <= near:
            return FOUND, DirectRay(cosine, slope * cosine, ray.time, ray.cosine, ray.sine, ray.q)
        if status == arcs.ENDLESS:
            break
        # A ray that takes too many steps winds about the axis of a duct.
        if status == arcs.HIGH or (status != arcs.LOW and miss > 0.0):
            most = slope
        else:
            least = slope
        rise = ray.q * cosine * cosine / ray.cosine  # of the height at that range with the launch slope
        guess = slope - miss / rise if status == arcs.RANGE and rise > 0.0 else math.nan
        if not least < guess < most:
            guess = _bisect_slopes(least, most)
        if guess == slope or guess == least or guess == most:
            break
        slope = guess
    return NONE, DirectRay(math.nan, math.nan, math.nan, math.nan, math.nan, math.nan)


@inlined
def _vertical_ray(height, speed, z_from, z_to):
    """Vertical ray between two heights."""
    sine = 1.0 if z_to >= z_from else -1.0
    ray = arcs.launch_in_layers(height, speed, z_from, 0.0, sine)
    while ray.z != z_to:
        _, ray = arcs.advance_in_layers(height, speed, ray, math.inf, min(z_to, z_from), max(z_to, z_from))
    return FOUND, DirectRay(0.0, sine, ray.time, 0.0, sine, ray.q)


@kernel
def follow_to_range(height, speed, ray, x, low, high):
    """Follow a ray to a ground range, or to its end if that comes first."""
    for _ in range(STEPS):
        status, ray = arcs.advance_in_layers(height, speed, ray, x, low, high)
        if status != arcs.NODE:
            return status, ray
    return arcs.NODE, ray


@inlined
def _guess_slope(height, speed, z_from, z_to, x):
    """Launch slope that would be right if the gradient were even between the two heights."""
    c0, dz = arcs.speed_at(height, speed, z_from), z_to - z_from
    if abs(dz) > arcs.SNAP:
        g = (arcs.speed_at(height, speed, z_to) - c0) / dz
    else:
        g = arcs.gradient_above(height, speed, arcs.node_below(height, z_from))
    return dz / x + 0.5 * g * (x * x + dz * dz) / (x * c0)


@inlined
def _bisect_slopes(least, most):
    """Halve a bracket of slopes, in angle while it is wide; open it further where it has no end."""
    if math.isinf(least) and math.isinf(most):
        return 0.0
    if math.isinf(least):
        return most - 0.5 - abs(most)
    if math.isinf(most):
        return least + 0.5 + abs(least)
    if most - least < 1e-3:
        return 0.5 * (least + most)
    return math.tan(0.5 * (math.atan(least) + math.atan(most)))
