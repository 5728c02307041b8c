"""Primitives: what one plane cuts of a convex body or a triangle, and where rays of the plane meet it.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.geometry.cross_sections import meet_solid
from insonify.kernels.targets.apparent_targets import ApparentSource, arrival_direction, plane_from_source

TRIANGLE = 2  # beside SPHERE and FRUSTUM
TINY = 1e-300
STEEPEST = 1e-17  # least cosine of a launch angle


class Primitive(NamedTuple):
    """One primitive as scalars, because passing tables between functions costs more than the geometry."""

    kind: int  # SPHERE, FRUSTUM or TRIANGLE
    x: float  # centre of a sphere, or of a frustum's first end, from the sonar; of a triangle's line
    y: float  # one end in the plane, x the ground range
    z: float
    ax: float  # axis of a frustum; from that end of a line to the other
    ay: float
    az: float
    length: float
    radius: float
    taper: float
    level_x: float  # the plane's azimuth; of a triangle, its normal's level part and upward part in the plane
    level_y: float
    source: ApparentSource  # through which it is seen


@inlined_uncounted
def load_primitive(solids, mesh, plane, body, line, source):
    """Load a primitive from the tables, as seen from the sonar or its apparent source."""
    k = body - solids.shape.size
    if k >= 0:
        level, up = mesh.normal[k, 0] * plane.ex + mesh.normal[k, 1] * plane.ey, mesh.normal[k, 2]
        if source.bent:
            # Turned back by as much as the ray has turned, so that its launch angle gives the incidence.
            c, s = source.arrival_cosine, source.arrival_sine
            level, up = level * c + up * s, up * c - level * s
        dx, dz = line[2] - line[0], line[3] - line[1]
        return Primitive(TRIANGLE, line[0], 0.0, line[1], dx, 0.0, dz, 0.0, 0.0, 0.0, level, up, source)
    if source.bent:
        plane = plane_from_source(source, plane)
    x, y, z = solids.start[body, 0] - plane.x, solids.start[body, 1] - plane.y, solids.start[body, 2] - plane.z
    ax, ay, az = solids.axis[body, 0], solids.axis[body, 1], solids.axis[body, 2]
    length, radius, taper = solids.length[body], solids.radius[body], solids.taper[body]
    return Primitive(solids.shape[body], x, y, z, ax, ay, az, length, radius, taper, plane.ex, plane.ey, source)


@inlined_uncounted
def target_of(solid_target, mesh_target, body):
    """Index of the declared target that a body belongs to, from those of all solids and of all triangles."""
    bodies = solid_target.size
    return solid_target[body] if body < bodies else mesh_target[body - bodies]


@inlined_uncounted
def intersect_primitive(primitive, c, s):
    """Slant range of a primitive along a ray of its plane, and the cosine of the incidence there."""
    distance, incidence, _ = meet_primitive(primitive, c, s)
    return distance, incidence


@inlined_uncounted
def meet_primitive(primitive, c, s):
    """Slant range of a primitive along a ray of its plane, and the inward normal there, as parts within the plane."""
    through = primitive.source.bent and primitive.kind != TRIANGLE
    if through:
        c, s = arrival_direction(primitive.source, c, s)
    distance, incidence, lean = _meet_straight(primitive, c, s)
    return (primitive.source.offset + primitive.source.gauge * distance if through else distance), incidence, lean


@inlined_uncounted
def _meet_straight(primitive, c, s):
    """Distance of a primitive along a straight ray from its apparent source, and both parts of the inward normal."""
    if primitive.kind == TRIANGLE:
        distance = (primitive.x * primitive.az - primitive.z * primitive.ax) / (c * primitive.az - s * primitive.ax)
        # Triangles scatter from both sides.
        facing, lean = c * primitive.level_x + s * primitive.level_y, c * primitive.level_y - s * primitive.level_x
        return (distance if distance > 0.0 else math.inf), abs(facing), math.copysign(1.0, facing) * lean
    return meet_solid(primitive, c, s)


@inlined_uncounted
def perpendicular_angle(line):
    """Launch angle at right angles to a triangle's line."""
    dx, dz = line[2] - line[0], line[3] - line[1]
    return math.atan2(-dx, dz) if dz >= 0.0 else math.atan2(dx, -dz)


@inlined_uncounted
def nearest_distance(line):
    """Distance to the nearest point of a triangle's line."""
    ax, az, dx, dz = line[0], line[1], line[2] - line[0], line[3] - line[1]
    share = -(ax * dx + az * dz) / max(dx * dx + dz * dz, TINY)
    share = min(max(share, 0.0), 1.0)
    return math.sqrt((ax + share * dx) ** 2 + (az + share * dz) ** 2)


@inlined_uncounted
def measure_directions(angle, cosine, sine):
    """Cosines and sines of launch angles by their series; the terms left out are less than 1e-17."""
    # The library's functions, called angle by angle, take ten times as long as this vector code.
    for k in range(angle.size):
        squared = angle[k] * angle[k]
        c = s = 1.0
        for n in range(22, 0, -2):
            c = 1.0 - squared * c * (1.0 / (n * (n - 1)))
            s = 1.0 - squared * s * (1.0 / (n * (n + 1)))
        cosine[k], sine[k] = max(c, STEEPEST), angle[k] * s


@inlined_uncounted
def bisect_directions(c_from, s_from, c_to, s_to):
    """Direction halfway between two others."""
    c, s = c_from + c_to, s_from + s_to
    per_norm = 1.0 / math.sqrt(c * c + s * s)
    return c * per_norm, s * per_norm
