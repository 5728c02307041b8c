"""Ray paths, eigenrays between two points and shadow zones in water packed for the kernels."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from insonify.arrays import Booleans, Floats
from insonify.kernels.common.types import Water
from insonify.kernels.refraction.eigenray_search import (
    ANGLE,
    BOTTOMS,
    COLUMNS,
    COSINE,
    GRAZED,
    ORDERS,
    SINE,
    TIME,
    TOPS,
    TUBE,
    TURNS,
    EndPoints,
    X,
    find_eigenrays,
    find_insonified_ranges,
)
from insonify.kernels.refraction.ray_paths import RayLimits, RayPoints, trace_ray_paths
from insonify.kernels.refraction.section_arcs import SectionPlane

FIRST_ROWS = 1024  # rows of a list at first
FAN = 4000  # rays sent through a section to find those that join two points
HALVINGS = 60  # of the angle between two rays of that fan
SEAM = 1e-5  # share of the farthest range: two insonified stretches this close are one
CLOSE = 1e-6  # m by which an eigenray may miss its point; one that misses by more marks the edge of a shadow
SAME_HEIGHT = 1e-11  # m by which heights may differ and are one: no angle tells the rays to them apart
ALONG_STATIONS = SectionPlane(0.0, 1.0)


def follow_paths(
    water: Water, height: float, angles: Floats, ranges: Floats, limits: RayLimits, along: SectionPlane = ALONG_STATIONS
) -> tuple[RayPoints, Any]:
    """Follow rays through the water, usually along the line of its stations."""
    shape = (angles.size, ranges.size + 1)
    x, z, cosine, sine, time, q = (np.full(shape, math.nan) for _ in range(6))
    turns, tops, bottoms = (np.zeros(shape, np.int64) for _ in range(3))
    points = RayPoints(x, z, cosine, sine, time, q, np.zeros(shape, np.bool_), turns, tops, bottoms)
    ends = np.zeros(angles.size, np.int64)
    trace_ray_paths(water, along, height, angles, ranges, limits, points, ends)
    return points, ends


def join_points(water: Water, z_from: float, z_to: float, x: float, low: float, high: float, most: int) -> Floats:
    """Find the rays between two points."""
    z_to = z_from if abs(z_to - z_from) < SAME_HEIGHT else z_to
    span = EndPoints(float(z_from), float(z_to), float(x), float(low), float(high), int(most))
    if water.station.size > 1:
        return _join_across(water, span)
    edges = _critical_angles(water, span)
    found = list_rows(lambda rows: find_eigenrays(water.height, water.speed[0], span, edges, rows), COLUMNS)
    return found[np.argsort(found[:, ANGLE], kind="stable")]


def list_rows(fill: Callable[[Floats], int], columns: int) -> Floats:
    """All rows of a kernel that fills as many as there is room for and returns how many it filled, or would fill."""
    room = FIRST_ROWS
    while True:
        rows = np.zeros((room, columns))
        count = int(fill(rows))
        if count < room:
            return rows[:count]
        room = max(2 * room, count + 1)


def _critical_angles(water: Water, span: EndPoints) -> Floats:
    """Launch angles at which rays graze a node, an end of the water or the target height, in radians, ascending."""
    nodes = (water.height > span.low) & (water.height < span.high)
    heights = np.array([z for z in (span.z_to, span.low, span.high) if math.isfinite(z)])
    speeds = np.concatenate([water.speed[0][nodes], np.interp(heights, water.height, water.speed[0])])
    cosines = np.interp(span.z_from, water.height, water.speed[0]) / speeds
    upwards = np.unique([0.0, *np.arccos(cosines[cosines < 1.0]), 0.5 * math.pi])
    halves = [-upwards[:0:-1] if span.z_from > span.low else [], [0.0], upwards[1:] if span.z_from < span.high else []]
    return np.concatenate(halves)


def _join_across(water: Water, span: EndPoints) -> Floats:
    """Find the eigenrays between two points of a section by bisecting a fan of rays about the point."""
    lower, upper = sorted((span.z_from, span.z_to))
    heights = np.linspace(lower - span.x, upper + span.x, FAN // 2)
    angles = np.union1d(np.arctan2(heights - span.z_from, span.x), np.linspace(-0.5, 0.5, FAN // 2 + 2)[1:-1] * math.pi)
    fan = _arrive(water, span, angles)
    first, last = fan[:-1], fan[1:]
    between = _opposite_signs(_miss(span, first), _miss(span, last))
    # Two more eigenrays may lie on either side of an extremum of the height over the launch angle.
    nears = _rise(span, first) * _miss(span, first) < 0.0
    leaves = _rise(span, last) * _miss(span, last) > 0.0
    hidden = ~between & nears & leaves
    extremum = _bisect(water, span, first[hidden], last[hidden], _rise)
    a, b = (
        np.concatenate([first[between], first[hidden], extremum]),
        np.concatenate([last[between], extremum, last[hidden]]),
    )
    bracketed = _opposite_signs(_miss(span, a), _miss(span, b))
    found = _bisect(water, span, a[bracketed], b[bracketed], _miss)
    few = found[:, TOPS] + found[:, BOTTOMS] <= span.reflections
    found = found[few & (np.abs(_miss(span, found)) < CLOSE)]
    found[:, X] = span.x
    return found[np.argsort(found[:, ANGLE], kind="stable")]


def _opposite_signs(a: Floats, b: Floats) -> Booleans:
    """Whether one of two values is above 0 and the other is not; never for NaN."""
    return np.isfinite(a) & np.isfinite(b) & ((a > 0.0) != (b > 0.0))


def _arrive(water: Water, span: EndPoints, angles: Floats) -> Floats:
    """Rays at the range of a point; column X is their height there, NaN for rays that do not reach it."""
    # A point on a reflecting boundary lies between rays that are reflected before it and beyond it.
    most = span.reflections + (span.z_to in (span.low, span.high))
    limits = RayLimits(span.x, span.low, span.high, most > 0, most > 0)
    points, _ = follow_paths(water, span.z_from, angles, np.array([span.x]), limits)
    rows = np.empty((angles.size, COLUMNS))
    rows[:, ANGLE] = angles
    kept = {X: points.z, TIME: points.time, COSINE: points.cosine, SINE: points.sine, TUBE: points.q}
    counted = {TURNS: points.turns, TOPS: points.tops, BOTTOMS: points.bottoms, GRAZED: points.grazed}
    for column, values in (kept | counted).items():
        rows[:, column] = values[:, 0]
    # The first point of a ray that ends before that range is its end.
    rows[(points.x[:, 0] != span.x) | (rows[:, TOPS] + rows[:, BOTTOMS] > most), X] = math.nan
    return rows


def _miss(span: EndPoints, rows: Floats) -> Floats:
    """Height of rays above the point, in metres, unfolded across a reflecting boundary on which the point lies."""
    return _reflection_sign(span, rows) * (rows[:, X] - span.z_to)


def _rise(span: EndPoints, rows: Floats) -> Floats:
    """Slope dz/dθ0 of the height above the point over the launch angle, in m/rad."""
    mirrored = (rows[:, TOPS] + rows[:, BOTTOMS]) % 2 == 1
    return _reflection_sign(span, rows) * np.where(mirrored, -1.0, 1.0) * rows[:, TUBE] / rows[:, COSINE]


def _reflection_sign(span: EndPoints, rows: Floats) -> Floats:
    """Sign of the unfolded height: -1 after an odd number of reflections at the boundary with the point, else 1."""
    if span.z_to == span.low:
        return 1.0 - 2.0 * (rows[:, BOTTOMS] % 2)
    if span.z_to == span.high:
        return 1.0 - 2.0 * (rows[:, TOPS] % 2)
    return np.ones(len(rows))


def _bisect(
    water: Water, span: EndPoints, a: Floats, b: Floats, value: Callable[[EndPoints, Floats], Floats]
) -> Floats:
    """Bisect between rays ``a`` and ``b`` to the sign change of a value; return the ray with fewer reflections."""
    above = value(span, a) > 0.0
    first, last = a.copy(), b.copy()
    for _ in range(HALVINGS):
        middle = _arrive(water, span, 0.5 * (first[:, ANGLE] + last[:, ANGLE]))
        before = (value(span, middle) > 0.0) == above
        first[before], last[~before] = middle[before], middle[~before]
    fewer = first[:, TOPS] + first[:, BOTTOMS] <= last[:, TOPS] + last[:, BOTTOMS]
    return np.where(fewer[:, None], first, last)


def find_shadows(water: Water, z_from: float, z_to: float, low: float, high: float, farthest: float) -> Floats:
    """Find the shadow zones: ranges at which no direct ray reaches a height in layered water."""
    span = EndPoints(float(z_from), float(z_to), math.inf, float(low), float(high), 0)
    edges = _critical_angles(water, span)
    lit = np.full((edges.size - 1, ORDERS, 2), math.inf)
    find_insonified_ranges(water.height, water.speed[0], span, edges, lit)
    pieces = lit.reshape(-1, 2)
    shadows, reached = [], 0.0
    for begin, end in pieces[np.argsort(pieces[:, 0], kind="stable")]:
        # Rays on either side of a critical angle arrive at the same range within rounding.
        if begin > reached + SEAM * farthest:
            shadows.append((reached, min(begin, farthest)))
        reached = max(reached, end)
        if reached >= farthest:
            break
    return np.array([shadow for shadow in shadows if shadow[0] < farthest]).reshape(-1, 2)
