"""All rays that join two points of layered water, those that turn and those that are reflected too.

A launch angle at which a ray grazes a node, or an end of the water, is *critical*. Between two critical angles rays
pass the same layers in the same order, and the range at which they come to a height for the n-th time is a smooth
function of the launch angle. Rays are launched at some angles in between. Every root and extremum that the ranges and
their exact derivatives reveal is refined.

Theory: docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.refraction import arcs

STEPS = 10_000  # layers that a ray may pass
ORDERS = 64  # most passages of one ray through the target height; along the axis of a duct they are unbounded
SAMPLES = 13  # rays between two critical angles
HALVINGS = 200  # of a bracket
BEYOND = 2.0  # times the target range, beyond which a ray ends
CLOSE = 1e-12  # accepted miss, as a share of the lengths involved
# Columns of a ray where it comes to the target height; q is signed as by `arcs.reflect_at_level`.
ANGLE, X, TIME, COSINE, SINE, TUBE, TURNS, TOPS, BOTTOMS, GRAZED = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
COLUMNS = 10


class EndPoints(NamedTuple):
    """Two points to join, and the ends of the water between them."""

    z_from: float  # heights, m
    z_to: float
    x: float  # ground range between them, m
    low: float  # heights at which rays are reflected; infinite ones are none
    high: float
    reflections: int  # how many a ray may have


@kernel
def find_eigenrays(height, speed, span, edges, found):
    """Rays that join two points of layered water.

    Parameters
    ----------
    height, speed : ndarray, shape (n,)
        Nodes of the water, ascending.
    span : EndPoints
    edges : ndarray
        Critical angles, ascending, rad, with 0, and right angles where rays can be launched that way.
    found : ndarray, shape (m, COLUMNS)
        Filled from its beginning, in the order of launch angles.

    Returns
    -------
    int
        Rays found; m if there may be more than there is room for.
    """
    if span.x <= 0.0:
        return _find_vertical_rays(height, speed, span, edges, found)
    count = 0
    angles, rows, row = np.empty(SAMPLES), np.empty((SAMPLES, ORDERS, COLUMNS)), np.empty((ORDERS, COLUMNS))
    before = np.full((ORDERS, COLUMNS), math.inf)
    for e in range(edges.size - 1):
        # At the critical angle itself rays belong to neither side.
        inset = _angle_uncertainty(edges[e])
        width = edges[e + 1] - _angle_uncertainty(edges[e + 1]) - edges[e] - inset
        if width <= 0.0:
            continue
        for i in range(SAMPLES):
            angles[i] = edges[e] + inset + 0.5 * width * (1.0 - math.cos(math.pi * i / (SAMPLES - 1)))
            _trace_crossings(height, speed, span, angles[i], rows[i])
        if edges[e] == 0.0:
            count = _add_level_ray(height, speed, span, found, count)
        for order in range(ORDERS):
            count = _add_critical_ray(height, speed, span, before[order], rows[0, order], found, count)
            if order > 0:
                # A ray that grazes the target height passes it twice at once.
                a, b = rows[0, order - 1], rows[-1, order - 1]
                count = _add_critical_ray(height, speed, span, a, rows[0, order], found, count)
                count = _add_critical_ray(height, speed, span, b, rows[-1, order], found, count)
            for i in range(SAMPLES - 1):
                a, b = rows[i, order], rows[i + 1, order]
                if _brackets(span, a, b):
                    count = _add_root(height, speed, span, order, a, b, row, found, count)
                elif _may_turn_back(span, a, b):
                    middle = _find_past_extremum(height, speed, span, order, a, b, row)
                    if _brackets(span, a, middle):
                        count = _add_root(height, speed, span, order, a, middle, row, found, count)
                        count = _add_root(height, speed, span, order, middle, b, row, found, count)
        before[:] = rows[SAMPLES - 1]
    return count


@inlined
def _angle_uncertainty(edge):
    """By how much a critical angle may be off, rad: an arc cosine is known to rounding over its sine."""
    if edge == 0.0:
        return 2e-16
    return 2e-16 * (1.0 + 4.0 * abs(edge)) + 1e-15 / abs(math.tan(edge))


@kernel
def _trace_crossings(height, speed, span, angle, rows):
    """Follow a ray and write its state at each passage through the target height; x is infinite where there is none."""
    for row in rows:
        row[ANGLE], row[X] = angle, math.inf
    cosine = math.cos(angle) if abs(angle) < 0.5 * math.pi else 0.0
    ray = arcs.launch_in_layers(height, speed, span.z_from, cosine, math.sin(angle))
    turns, tops, bottoms, order = 0, 0, 0, 0
    for _ in range(STEPS):
        sine = ray.sine
        below = ray.z < span.z_to or (ray.z == span.z_to and sine < 0.0)
        low = span.low if below else max(span.low, span.z_to)
        high = min(span.high, span.z_to) if below else span.high
        status, ray = arcs.advance_in_layers(height, speed, ray, math.inf, low, high)
        if status == arcs.ENDLESS:
            return
        if ray.sine * sine < 0.0:
            turns += 1
        if status == arcs.NODE:
            continue
        if ray.z == span.z_to:
            row = rows[order]
            row[X], row[TIME], row[TUBE], row[COSINE], row[SINE] = ray.x, ray.time, ray.q, ray.cosine, ray.sine
            row[TURNS], row[TOPS], row[BOTTOMS], row[GRAZED] = turns, tops, bottoms, 1.0 if ray.grazed else 0.0
            order += 1
            if order == rows.shape[0] or ray.x > BEYOND * span.x:
                return
        if ray.z == span.high:
            tops += 1
        elif ray.z == span.low:
            bottoms += 1
        else:
            k = arcs.node_below(height, ray.z)
            if k >= 0 and ray.z - height[k] <= arcs.SNAP:
                ray = arcs.enter_layer(height, speed, ray, k)
            continue
        if tops + bottoms > span.reflections:
            return
        ray = arcs.reflect_at_level(ray, arcs.gradient_behind(height, speed, ray))


@inlined
def _brackets(span, a, b):
    """Whether the target range lies between those of two rays."""
    return (a[X] > span.x) != (b[X] > span.x)


@inlined
def _range_rate(row):
    """dx/dθ0 of the range at which a ray comes to the target height, m/rad."""
    flipped = (row[TOPS] + row[BOTTOMS]) % 2.0 == 1.0
    return row[TUBE] / row[SINE] if flipped else -row[TUBE] / row[SINE]


@inlined
def _may_turn_back(span, a, b):
    """Whether an extremum between two rays on one side of the target range may reach across it."""
    if math.isinf(a[X]) or math.isinf(b[X]):
        return False
    if a[X] > span.x:
        return _range_rate(a) < 0.0 < _range_rate(b)
    return _range_rate(a) > 0.0 > _range_rate(b)


@kernel
def _find_past_extremum(height, speed, span, order, a, b, row):
    """Ray between two on the other side of the target range, or the one that comes nearest to it."""
    first, last, falls = a[ANGLE], b[ANGLE], _range_rate(a) < 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (first + last)
        _trace_crossings(height, speed, span, middle, row[: order + 1])
        if _brackets(span, a, row[order]) or middle == first or middle == last:
            break
        if (_range_rate(row[order]) < 0.0) == falls:
            first = middle
        else:
            last = middle
    return row[order].copy()


@kernel
def _add_root(height, speed, span, order, a, b, row, found, count):
    """Add the ray between two on either side of the target range, by Newton's steps or by halving where those stray."""
    if count == found.shape[0]:
        return count
    first, last, beyond = a[ANGLE], b[ANGLE], a[X] > span.x
    close = CLOSE * (span.x + abs(span.z_from) + abs(span.z_to))
    angle, stride = 0.5 * (first + last), last - first
    for _ in range(HALVINGS):
        _trace_crossings(height, speed, span, angle, row[: order + 1])
        miss = row[order, X] - span.x
        if abs(miss) <= close:
            break
        if (miss > 0.0) == beyond:
            first = angle
        else:
            last = angle
        guess = angle - miss / _range_rate(row[order])
        if not (first < guess < last and abs(guess - angle) < 0.5 * stride):
            guess = 0.5 * (first + last)
        if guess == first or guess == last:
            break
        angle, stride = guess, abs(guess - angle)
    if abs(row[order, X] - span.x) > _tolerated_miss(span):
        return count  # one of the two rays ends before, or never comes there
    found[count] = row[order]
    _correct_time(height, speed, span, found[count])
    return count + 1


@inlined
def _correct_time(height, speed, span, row):
    """Correct the travel time for what a ray still misses in range, where neighbours come later by dt/dx = ξ."""
    # Along the edge of a gradient tubes are so wide that the last digit of an angle moves its ray by 10⁻⁸ m and more.
    row[TIME] -= (row[X] - span.x) * row[COSINE] / arcs.speed_at(height, speed, span.z_to)
    row[X] = span.x


@inlined
def _tolerated_miss(span):
    """Miss of a ray known to the last digit of its angle, m: near a critical one ranges change by its square root."""
    return 1e-3 + 1e-6 * span.x


@inlined
def _add_critical_ray(height, speed, span, a, b, found, count):
    """Add the ray at a critical angle, if the target range lies between the nearly equal ones on its two sides."""
    if count < found.shape[0] and _brackets(span, a, b) and abs(a[X] - b[X]) < _tolerated_miss(span):
        found[count] = a if abs(a[X] - span.x) < abs(b[X] - span.x) else b
        _correct_time(height, speed, span, found[count])
        return count + 1
    return count


@inlined
def _add_level_ray(height, speed, span, found, count):
    """Add the ray that stays level, if the water keeps it so."""
    if span.z_to != span.z_from or count == found.shape[0]:
        return count
    ray = arcs.launch_in_layers(height, speed, span.z_from, 1.0, 0.0)
    k, g, _, _ = arcs.find_layer(height, speed, ray)
    pressed = span.z_from == span.high and arcs.gradient_above(height, speed, k - 1) < 0.0
    pressed = pressed or (span.z_from == span.low and arcs.gradient_above(height, speed, k) > 0.0)
    if g == 0.0 and not pressed:
        found[count] = 0.0
        found[count, X], found[count, TIME], found[count, COSINE] = span.x, span.x / ray.speed, 1.0
        found[count, TUBE] = span.x
        return count + 1
    return count


@kernel
def _find_vertical_rays(height, speed, span, edges, found):
    """Find the vertical rays between two points one above the other."""
    count = 0
    rows = np.empty((ORDERS, COLUMNS))
    for angle in (edges[0], edges[edges.size - 1]):
        if abs(angle) == 0.5 * math.pi:
            _trace_crossings(height, speed, span, angle, rows)
            for row in rows:
                if count < found.shape[0] and not math.isinf(row[X]):
                    found[count] = row
                    count += 1
    return count


@kernel
def find_insonified_ranges(height, speed, span, edges, lit):
    """Ground ranges at which direct rays come to a height.

    Parameters
    ----------
    height, speed : ndarray, shape (n,)
        Nodes of the water, ascending.
    span : EndPoints
        Of any range.
    edges : ndarray, shape (m + 1,)
        As for `find_eigenrays`.
    lit : ndarray, shape (m, orders, 2)
        Filled with the least and greatest range of the rays between two critical angles that come for the first,
        second ... time, m; infinite where none does.
    """
    lit[:] = math.inf
    everywhere = EndPoints(span.z_from, span.z_to, math.inf, span.low, span.high, span.reflections)
    orders = lit.shape[1]
    rows, row = np.empty((SAMPLES, orders, COLUMNS)), np.empty((orders, COLUMNS))
    for e in range(edges.size - 1):
        inset = 1e-12 * (edges[e + 1] - edges[e])
        for i in range(SAMPLES):
            share = 0.5 * (1.0 - math.cos(math.pi * i / (SAMPLES - 1)))
            angle = edges[e] + inset + share * (edges[e + 1] - edges[e] - 2.0 * inset)
            _trace_crossings(height, speed, everywhere, angle, rows[i])
        for order in range(orders):
            least, most = rows[:, order, X].min(), rows[:, order, X].max()
            for i in range(SAMPLES - 1):
                a, b = rows[i, order], rows[i + 1, order]
                if math.isinf(a[X]) or math.isinf(b[X]) or _range_rate(a) * _range_rate(b) >= 0.0:
                    continue
                x = _find_past_extremum(height, speed, everywhere, order, a, b, row)[X]
                least, most = min(least, x), max(most, x)
            lit[e, order, 0], lit[e, order, 1] = least, most
