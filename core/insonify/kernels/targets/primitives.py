"""One part of a screen by itself: a convex body or a triangle, as one plane cuts it."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.kernels.common.jit import inlined_uncounted
from insonify.kernels.common.types import SPHERE
from insonify.kernels.geometry.solids import frustum_normal, intersect_frustum, intersect_sphere
from insonify.kernels.targets.apparent_targets import ApparentSource, arrival_direction, plane_from_source

TRIANGLE = 2  # beside SPHERE and FRUSTUM
TINY = 1e-300


class Primitive(NamedTuple):
    """One part by itself: numbers alone, for tables handed from function to function cost more than the geometry."""

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
    lens: ApparentSource  # through which it is seen


@inlined_uncounted
def load_primitive(solids, mesh, view, body, line, lens):
    """Take out of the tables what a part is like, from where the sonar stands or seems to."""
    k = body - solids.shape.size
    if k >= 0:
        level, up = mesh.normal[k, 0] * view.ex + mesh.normal[k, 1] * view.ey, mesh.normal[k, 2]
        if lens.bent:
            # Back by as much as the ray has turned, so that its launch angle tells the incidence.
            c, s = lens.arrival_cosine, lens.arrival_sine
            level, up = level * c + up * s, up * c - level * s
        dx, dz = line[2] - line[0], line[3] - line[1]
        return Primitive(TRIANGLE, line[0], 0.0, line[1], dx, 0.0, dz, 0.0, 0.0, 0.0, level, up, lens)
    if lens.bent:
        view = plane_from_source(lens, view)
    return Primitive(
        solids.shape[body],
        solids.start[body, 0] - view.x,
        solids.start[body, 1] - view.y,
        solids.start[body, 2] - view.z,
        solids.axis[body, 0],
        solids.axis[body, 1],
        solids.axis[body, 2],
        solids.length[body],
        solids.radius[body],
        solids.taper[body],
        view.ex,
        view.ey,
        lens,
    )


@inlined_uncounted
def intersect_primitive(part, c, s):
    """Slant range of a part in the direction (c, s), and the cosine of the incidence there; infinite if missed."""
    through = part.lens.bent and part.kind != TRIANGLE
    if through:
        c, s = arrival_direction(part.lens, c, s)
    distance, incidence = _meet(part, c, s)
    return (part.lens.offset + part.lens.gauge * distance if through else distance), incidence


@inlined_uncounted
def _meet(part, c, s):
    """Likewise, from where the sonar seems to be."""
    if part.kind == TRIANGLE:
        distance = (part.x * part.az - part.z * part.ax) / (c * part.az - s * part.ax)
        # Sheets are heard from both sides.
        return (distance if distance > 0.0 else math.inf), abs(c * part.level_x + s * part.level_y)
    dx, dy = c * part.level_x, c * part.level_y
    if part.kind == SPHERE:
        distance, _ = intersect_sphere(part.x, part.y, part.z, part.radius, dx, dy, s)
        inwards = (part.x * dx + part.y * dy + part.z * s - distance) / part.radius
        return (distance if distance > 0.0 else math.inf), inwards
    distance, face, _, _ = intersect_frustum(
        part.x, part.y, part.z, part.ax, part.ay, part.az, part.length, part.radius, part.taper, dx, dy, s
    )
    if not 0.0 < distance < math.inf:
        return math.inf, 0.0
    px, py, pz = distance * dx - part.x, distance * dy - part.y, distance * s - part.z
    nx, ny, nz = frustum_normal(px, py, pz, part.ax, part.ay, part.az, part.radius, part.taper, face)
    return distance, -(nx * dx + ny * dy + nz * s)


@inlined_uncounted
def perpendicular_angle(line):
    """Launch angle at right angles to the line of a triangle's part."""
    dx, dz = line[2] - line[0], line[3] - line[1]
    return math.atan2(-dx, dz) if dz >= 0.0 else math.atan2(dx, -dz)


@inlined_uncounted
def nearest_distance(line):
    """Distance to the nearest point of a triangle's part."""
    ax, az, dx, dz = line[0], line[1], line[2] - line[0], line[3] - line[1]
    share = -(ax * dx + az * dz) / max(dx * dx + dz * dz, TINY)
    share = min(max(share, 0.0), 1.0)
    return math.sqrt((ax + share * dx) ** 2 + (az + share * dz) ** 2)
