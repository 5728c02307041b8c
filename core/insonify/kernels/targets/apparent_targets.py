"""Apparent positions of targets in layered water: each primitive as seen from a source in uniform water.

Near a target the rays of one plane are nearly those of a source in uniform water: straight, from the centre of their
wavefront, the *apparent source*. The cross-section of a convex body is taken from there, and directions and distances
are turned into launch angles and slant ranges. A triangle's straight line stays one between its ends, each put at its
apparent position. Derived in docs/theory/refraction.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import TWO_INTEGERS, inlined_uncounted, kernel_separate
from insonify.kernels.geometry.cross_sections import DOWN, UP, HalfPlane, middle_of_section, section_solid
from insonify.kernels.refraction.apparent_positions import look_up_position

SECANT = 0.5  # m, to either side of a body's middle, where its slant ranges are exact and its rays' opening is taken
LEAST_OPENING, MOST_OPENING = 0.05, 5.0
NEAREST = 1e-3  # m, that a body's middle may come to the sonar
SAME = 1e-9  # rad; a line that fills less is seen edge-on
FIELDS = 11  # numbers of an apparent source


class ApparentSource(NamedTuple):
    """Source in uniform water that stands for the refraction of the rays to one primitive."""

    bent: bool
    launch_cosine: float  # of the ray to the primitive's middle
    launch_sine: float
    arrival_cosine: float  # of its arrival there; of a triangle, of the angle by which it has turned
    arrival_sine: float
    opening: float  # change of the direction of arrival with that of launch
    offset: float  # slant range is offset + gauge · distance from the apparent source
    gauge: float
    gain: float  # what the primitive's energy must be multiplied by
    level: float  # apparent ground range over the true one
    source_x: float  # ground range and height of the apparent source
    source_z: float


@inlined_uncounted
def load_apparent_source(bent, row):
    """Apparent source of a primitive."""
    if not bent:
        return ApparentSource(False, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0)
    return ApparentSource(True, row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9], row[10])


@inlined_uncounted
def rays_apart(source, distance):
    """Distance across the rays per launch angle at a slant range: how far apart neighbouring rays are there."""
    return source.opening * (distance - source.offset)


@inlined_uncounted
def _store_apparent_source(source, row):
    """Store an apparent source in its row of the z-buffer."""
    row[0], row[1] = source.launch_cosine, source.launch_sine
    row[2], row[3] = source.arrival_cosine, source.arrival_sine
    row[4], row[5], row[6], row[7] = source.opening, source.offset, source.gauge, source.gain
    row[8], row[9], row[10] = source.level, source.source_x, source.source_z


@inlined_uncounted
def arrival_direction(source, c, s):
    """Direction in which a ray arrives at a primitive: tan ψ = opening · tan θ, from the middle ray's directions."""
    along = c * source.launch_cosine + s * source.launch_sine
    across = source.opening * (s * source.launch_cosine - c * source.launch_sine)
    per_norm = 1.0 / math.sqrt(along * along + across * across)
    along, across = along * per_norm, across * per_norm
    return (
        along * source.arrival_cosine - across * source.arrival_sine,
        along * source.arrival_sine + across * source.arrival_cosine,
    )


@inlined_uncounted
def _launch_from_arrival(source, angle):
    """Launch angle of the ray that arrives at a primitive at an angle."""
    turned = angle - math.atan2(source.arrival_sine, source.arrival_cosine)
    launch = math.atan2(source.launch_sine, source.launch_cosine)
    return launch + math.atan2(math.sin(turned), source.opening * math.cos(turned))


@inlined_uncounted
def plane_from_source(source, plane):
    """Half-plane from a primitive's apparent source instead of the sonar."""
    x, y = plane.x + source.source_x * plane.ex, plane.y + source.source_x * plane.ey
    return HalfPlane(x, y, plane.z + source.source_z, plane.ex, plane.ey)


@kernel_separate(TWO_INTEGERS)
def apply_apparent_sources(arrays, plane, one_wide, table, grid, zbuffer, bodies, primitives):
    """Put the primitives of a z-buffer to their apparent positions, in place, and drop those seen edge-on."""
    kept = 0
    for p in range(bodies):
        k, rim = zbuffer.body[p], zbuffer.rim[kept]
        source = _apparent_source_of_solid(arrays.solids, k, plane, one_wide, table, grid)
        is_cut, low, high = section_solid(arrays.solids, k, plane_from_source(source, plane), rim)
        if is_cut:
            for end in range(rim.size):
                rim[end] = _launch_from_arrival(source, rim[end]) if abs(rim[end]) <= math.pi else rim[end]
            low, high = _launch_from_arrival(source, low), _launch_from_arrival(source, high)
            kept = _keep_primitive(zbuffer, kept, k, source, max(low, DOWN), min(high, UP))
    bodies_kept = kept
    for p in range(bodies, primitives):
        source = _apparent_source_of_line(zbuffer.line[p], one_wide, table, grid)
        for end in range(4):
            zbuffer.line[kept, end] = zbuffer.line[p, end]
        line = zbuffer.line[kept]
        one, other = math.atan2(line[1], line[0]), math.atan2(line[3], line[2])
        kept = _keep_primitive(zbuffer, kept, zbuffer.body[p], source, min(one, other), max(one, other))
    return bodies_kept, kept


@inlined_uncounted
def _keep_primitive(zbuffer, kept, body, source, low, high):
    """Enter a primitive after those that are kept, if it is not seen edge-on; return their number."""
    if high - low <= SAME:
        return kept
    zbuffer.body[kept], zbuffer.low[kept], zbuffer.high[kept] = body, low, high
    _store_apparent_source(source, zbuffer.source[kept])
    return kept + 1


@inlined_uncounted
def _energy_gain(wide, tube, one_wide):
    """Factor by which refraction multiplies a primitive's energy, as for a profile."""
    return (wide * wide if one_wide else wide) / tube


@inlined_uncounted
def _apparent_source_of_line(line, one_wide, table, grid):
    """Put the ends of a triangle's line at their apparent positions; return what else refraction does to it."""
    x, z = 0.5 * (line[0] + line[2]), 0.5 * (line[1] + line[3])
    wide, _, tube, turn = look_up_position(table, grid, x, z)
    for end in range(0, 4, 2):
        level, rise, _, _ = look_up_position(table, grid, line[end], line[end + 1])
        line[end] *= 1.0 + level
        line[end + 1] += rise
    gain = _energy_gain(1.0 + wide, 1.0 + tube, one_wide)
    return ApparentSource(True, 1.0, 0.0, math.cos(turn), math.sin(turn), 1.0, 0.0, 1.0, gain, 1.0 + wide, 0.0, 0.0)


@inlined_uncounted
def _apparent_source_of_solid(solids, k, plane, one_wide, table, grid):
    """Apparent source of a convex body, from the ray to the middle of its cross-section."""
    x, z = middle_of_section(solids, k, plane)
    wide, rise, tube, turn = look_up_position(table, grid, x, z)
    seen_x, seen_z = x * (1.0 + wide), z + rise
    r = max(math.sqrt(seen_x * seen_x + seen_z * seen_z), NEAREST)
    launch = math.atan2(seen_z, seen_x)
    c, s = math.cos(launch + turn), math.sin(launch + turn)
    ahead = min(SECANT, 0.5 * r)
    near_r, near_q = _wavefront(x - ahead * c, z - ahead * s, table, grid)
    far_r, far_q = _wavefront(x + ahead * c, z + ahead * s, table, grid)
    opening = min(max((far_q - near_q) / (2.0 * ahead), LEAST_OPENING), MOST_OPENING)
    gauge = (far_r - near_r) / (2.0 * ahead)
    away = (1.0 + tube) * r / opening  # radius of the wavefront: docs/theory/refraction.md
    return ApparentSource(
        True,
        math.cos(launch),
        math.sin(launch),
        c,
        s,
        opening,
        near_r - gauge * (away - ahead),
        gauge,
        _energy_gain(1.0 + wide, 1.0 + tube, one_wide),
        1.0 + wide,
        x - away * c,
        z - away * s,
    )


@inlined_uncounted
def _wavefront(x, z, table, grid):
    """Slant range of a place, and distance across the rays there per launch angle."""
    wide, rise, tube, _ = look_up_position(table, grid, x, z)
    seen_x, seen_z = x * (1.0 + wide), z + rise
    r = math.sqrt(seen_x * seen_x + seen_z * seen_z)
    return r, (1.0 + tube) * r
