"""Rays through layered water: in each layer speed is linear in height, so that a ray is an arc of a circle.

An arc is described by its *tangents* T: the tangents at its two ends meet, and T is the sum of their lengths. With κ
the curvature, s the arc's length, u0 and u1 the directions at its ends,

    T = 2 tan(κs/2) / κ,   displacement = T (u0 + u1)/2,   ∫c ds = T (c0 + c1)/2,

so that nothing is divided by the gradient, rays may be vertical, and turning points need no special case. κ = gξ with g
the gradient and ξ = cosθ/c Snell's constant; θ is positive upwards, and κ is positive for rays that bend down.

The ray tube follows p and q of dynamic ray tracing (Červený 2001, chapter 4; Jensen et al., Computational Ocean
Acoustics, 3.3): q is the distance across the ray between rays launched 1 rad apart, so that intensity over that at 1 m
is cosθ0 / (x |q|). The arcs are derived in docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined

# How a step ends: at a node of the water, at the given range or height, or never.
NODE, RANGE, LOW, HIGH, ENDLESS = 0, 1, 2, 3, 4
SNAP = 1e-9  # a ray within this of a node is on it, m
GRAZING = 1e-7  # least sine of the angle at which a ray counts as meeting a jump of the gradient


class RayState(NamedTuple):
    """Where a ray is in its own vertical plane, its direction, travel time and ray tube."""

    x: float  # ground range, m
    z: float  # height, m
    cosine: float  # of its direction above the horizontal
    sine: float
    speed: float  # of sound here, m/s
    time: float  # travelled, s
    p: float  # slowness across the ray by which q grows, s/m
    q: float  # distance across the ray per launch angle, m/rad
    grazed: bool  # whether it met a jump of the gradient below GRAZING, so that p and q are capped


@inlined
def node_below(height, z):
    """Highest node of the water at or below a height."""
    low, high = 0, height.size
    while low < high:
        middle = (low + high) // 2
        if height[middle] <= z + SNAP:
            low = middle + 1
        else:
            high = middle
    return low - 1


@inlined
def gradient_above(height, speed, k):
    """Gradient dc/dz between nodes k and k + 1."""
    if k < 0 or k >= height.size - 1:
        return 0.0
    return (speed[k + 1] - speed[k]) / (height[k + 1] - height[k])


@inlined
def speed_at(height, speed, z):
    """Speed of sound at a height."""
    k = node_below(height, z)
    if k < 0:
        return speed[0]
    return speed[k] + gradient_above(height, speed, k) * max(z - height[k], 0.0)


@inlined
def launch_in_layers(height, speed, z, cosine, sine):
    """Ray at its start, at ground range 0."""
    c = speed_at(height, speed, z)
    return RayState(0.0, z, cosine, sine, c, 0.0, 1.0 / c, 0.0, False)


@inlined
def advance_in_layers(height, speed, ray, x_end, low, high):
    """Follow a ray to the next node of the water, to a ground range or to a height, whichever comes first."""
    layer, g, floor, ceiling = find_layer(height, speed, ray)
    level, s1, tangents = _reach_level(ray, g, max(floor, low), min(ceiling, high))
    by_range, _ = reach_line(ray.cosine, -ray.sine, x_end - ray.x, g * ray.cosine / ray.speed)
    if by_range == math.inf and tangents == math.inf:
        return ENDLESS, ray
    if by_range > tangents:
        there = _follow_to_level(ray, g, tangents, level, s1)
        if level == low:
            return LOW, there
        if level == high:
            return HIGH, there
        return NODE, enter_layer(height, speed, there, layer + 1 if level == ceiling else layer)
    at = follow_arc(ray, 0.0, g, by_range)
    there = RayState(x_end, at.z, at.cosine, at.sine, at.speed, at.time, at.p, at.q, at.grazed)  # there exactly
    comes = there.sine > 0.0 if level == ceiling else there.sine < 0.0
    if comes and level != low and level != high and abs(there.z - level) <= SNAP:
        # The next step finds the ray on the node: it enters the layer beyond now.
        return RANGE, enter_layer(height, speed, there, layer + 1 if level == ceiling else layer)
    return RANGE, there


@inlined
def find_layer(height, speed, ray):
    """Layer that a ray enters next."""
    k = node_below(height, ray.z)
    g = gradient_above(height, speed, k)
    on_node = k >= 0 and ray.z - height[k] <= SNAP
    # A ray on a node belongs to the side it heads for, a level one to the side it bends to.
    if on_node and (ray.sine < 0.0 or (ray.sine == 0.0 and g >= 0.0)):
        under = gradient_above(height, speed, k - 1)
        if ray.sine == 0.0 and under <= 0.0:
            # Sound is slowest here: a level ray stays on the node.
            return k, 0.0, -math.inf, math.inf
        k, g = k - 1, under
    floor, ceiling = -math.inf, math.inf
    if k >= 0:
        floor = height[k]
    if k < height.size - 1:
        ceiling = height[k + 1]
    return k, g, floor, ceiling


@inlined
def _reach_level(ray, g, floor, ceiling):
    """Border of a layer that a ray meets, the sine of its direction there, and the tangents of the arc to it."""
    bend = g * ray.cosine / ray.speed
    up = ray.sine > 0.0 or (ray.sine == 0.0 and g < 0.0)
    if up:
        tangents, s1 = reach_line(ray.sine, ray.cosine, ceiling - ray.z, bend)
        if tangents < math.inf or math.isinf(ceiling):
            return ceiling, s1, tangents
    # It goes down, or turns below the ceiling.
    tangents, s1 = reach_line(-ray.sine, -ray.cosine, ray.z - floor, bend)
    if up or tangents < math.inf or math.isinf(floor):
        return floor, -s1, tangents
    tangents, s1 = reach_line(ray.sine, ray.cosine, ceiling - ray.z, bend)
    return ceiling, s1, tangents


@inlined
def reach_line(along, across, distance, bend):
    """Tangents of the arc from a ray to a straight line ahead."""
    if math.isinf(distance):
        return math.inf, 0.0
    d = max(distance, 0.0)
    # d = T (along + along1)/2 at either end of the arc: a quadratic in T, solved without a difference of near equals.
    fall = bend * (2.0 * across + d * bend)
    square = along * along - d * fall
    if square < 0.0:
        return math.inf, 0.0
    there = math.sqrt(square)
    if along > 0.0:
        return 2.0 * d / (along + there), there
    if fall < 0.0:
        return 2.0 * (along - there) / fall, there
    return math.inf, 0.0


@inlined
def follow_arc(ray, gx, gz, tangents):
    """Ray at the other end of an arc of known tangents."""
    turn = 0.5 * tangents * (ray.cosine * gz - ray.sine * gx) / ray.speed  # tan(κs/2)
    over = 1.0 / (1.0 + turn * turn)
    cosine = (ray.cosine * (1.0 - turn * turn) + 2.0 * turn * ray.sine) * over
    sine = (ray.sine * (1.0 - turn * turn) - 2.0 * turn * ray.cosine) * over
    dx, dz = 0.5 * tangents * (ray.cosine + cosine), 0.5 * tangents * (ray.sine + sine)
    speed = ray.speed + gx * dx + gz * dz
    time, q = _add_time_and_spread(ray, gx * gx + gz * gz, turn, tangents, speed)
    return RayState(ray.x + dx, ray.z + dz, cosine, sine, speed, time, ray.p, q, ray.grazed)


@inlined
def _follow_to_level(ray, g, tangents, level, sine):
    """Ray at the other end of an arc of layered water, from its height and direction there."""
    speed = ray.speed + g * (level - ray.z)
    cosine = ray.cosine / ray.speed * speed
    time, q = _add_time_and_spread(ray, g * g, 0.5 * tangents * g * ray.cosine / ray.speed, tangents, speed)
    x = ray.x + 0.5 * tangents * (ray.cosine + cosine)
    return RayState(x, level, cosine, sine, speed, time, ray.p, q, ray.grazed)


@inlined
def _add_time_and_spread(ray, square, turn, tangents, speed):
    """Travel time and q at the other end of an arc, by the squared gradient, tan(κs/2), T, and the speed there."""
    # Of the chord D = T cos(κs/2), squared, over the speeds at its ends.
    chord = tangents * tangents / ((1.0 + turn * turn) * ray.speed * speed)
    time = ray.time + math.sqrt(chord) * _asinh_ratio(0.25 * square * chord)
    return time, ray.q + ray.p * 0.5 * tangents * (ray.speed + speed)


@inlined
def _asinh_ratio(square):
    """asinh(y)/y of y², 1 at 0."""
    if square < 1e-3:
        series = -5.0 / 112.0 + square * (35.0 / 1152.0)
        return 1.0 + square * (-1.0 / 6.0 + square * (3.0 / 40.0 + square * series))
    y = math.sqrt(square)
    return math.asinh(y) / y


@inlined
def enter_layer(height, speed, ray, node):
    """Ray that has come to a node where it enters the layer beyond: the jump of the gradient bends the tube."""
    jump = gradient_above(height, speed, node) - gradient_above(height, speed, node - 1)
    there = RayState(ray.x, height[node], ray.cosine, ray.sine, speed[node], ray.time, ray.p, ray.q, ray.grazed)
    return _bend_tube_at_level(there, -jump)


@inlined
def reflect_at_level(ray, g):
    """Ray reflected by a level surface."""
    there = _bend_tube_at_level(ray, 2.0 * g if ray.sine > 0.0 else -2.0 * g)
    return RayState(
        there.x, there.z, there.cosine, -there.sine, there.speed, there.time, there.p, there.q, there.grazed
    )


@inlined
def gradient_behind(height, speed, ray):
    """Gradient dc/dz on the side that a ray comes from, up or down."""
    k = node_below(height, ray.z)
    on_node = k >= 0 and ray.z - height[k] <= SNAP
    return gradient_above(height, speed, k - 1 if on_node and ray.sine > 0.0 else k)


@inlined
def _bend_tube_at_level(ray, fall):
    """Bend the tube at a level interface where dc/dz falls upwards by ``fall``, 1/s, whichever way the ray goes."""
    flat = abs(ray.sine) < GRAZING
    return bend_tube(ray, fall * ray.cosine * ray.cosine / max(abs(ray.sine), GRAZING), flat)


@inlined
def bend_tube(ray, strength, flat):
    """Ray with its tube bent by a jump of the gradient."""
    p = ray.p + ray.q * strength / (ray.speed * ray.speed)
    grazed = ray.grazed or (flat and ray.q * strength != 0.0)
    return RayState(ray.x, ray.z, ray.cosine, ray.sine, ray.speed, ray.time, p, ray.q, grazed)
