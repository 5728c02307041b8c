"""Targets as one plane shows them to the sonar: a row of cells of launch angle, each with what is nearest in it.

A plane cuts a convex body in one figure and a triangle in one straight line, its *parts*. Between neighbouring ends of
parts the same parts lie before and behind one another, so that asking in the middle of a cell answers for all of it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.jit import fused, kernel
from insonify.kernels.sections import DOWN, NEVER, UP, reached, section
from insonify.kernels.shapes import cross_frustum, cross_sphere, frustum_normal
from insonify.kernels.types import SPHERE, Mesh, Solids

FACETS = 64  # cells of a convex body alone in its plane, closer together towards its edges
EDGE = 1e-9  # share of an interval by which the outermost cells of a body end inside it, to be sure to meet it
SAME = 1e-9  # rad; ends of parts closer together are one
SPREAD = np.cos(np.pi * np.arange(FACETS + 1) / FACETS)
NOBODY = -1
TRIANGLE = 2  # beside SPHERE and FRUSTUM


class Part(NamedTuple):
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


class Screen(NamedTuple):
    """Parts, then cells; arrays are longer than their numbers."""

    body: NDArray[np.int64]  # row of the solids, or beyond them the triangle, of each part
    low: NDArray[np.float64]  # launch angle above the horizontal at which the part begins, rad
    high: NDArray[np.float64]  # and ends
    line: NDArray[np.float64]  # (parts, 4) of a triangle's part: ground range and height above the sonar of its ends
    edge: NDArray[np.float64]  # launch angles at which cells begin; the last one ends the last cell
    cosine: NDArray[np.float64]  # of the edges
    sine: NDArray[np.float64]
    part: NDArray[np.int64]  # part nearest in each cell, or NOBODY
    distance: NDArray[np.float64]  # to it along the middle of the cell, infinite where there is none
    incidence: NDArray[np.float64]  # cosine of the incidence there
    near: NDArray[np.float64]  # distance to it along the edge where the cell begins
    far: NDArray[np.float64]  # and where it ends


def empty_screen(solids: Solids, mesh: Mesh) -> Screen:
    """Make room for all that a plane may cut of a scene."""
    bodies, triangles = solids.shape.size, mesh.target.size
    parts, cells = bodies + triangles, bodies * (FACETS + 1) + 3 * triangles + 1
    low, high = np.zeros((2, parts))
    edge, cosine, sine, distance, incidence, near, far = np.zeros((7, cells))
    body, part = np.zeros(parts, np.int64), np.zeros(cells, np.int64)
    return Screen(body, low, high, np.zeros((parts, 4)), edge, cosine, sine, part, distance, incidence, near, far)


@fused
def fill_screen(problem, view, reach, screen):
    """Collect what a plane cuts; return the number of cells, -1 - k if the sonar is inside body k."""
    parts = _cut_solids(problem.solids, view, reach, screen)
    if parts < 0:
        return parts
    solid_parts = parts
    if problem.mesh.target.size > 0:
        parts = cut_mesh(problem.mesh, problem.solids.shape.size, view, reach, screen, parts)
    if parts == 0:
        return 0
    return _fill_cells(problem, view, screen, solid_parts, parts)


@fused
def _cut_solids(solids, view, reach, screen):
    parts = 0
    for k in range(solids.shape.size):
        if reached(solids, k, view, reach):
            status, low, high = section(solids, k, view)
            if status < 0:
                return -1 - k
            if status > 0:
                screen.body[parts], screen.low[parts], screen.high[parts] = k, low, high
                parts += 1
    return parts


@kernel
def cut_mesh(mesh, first_body, view, reach, screen, parts):
    """Add the lines in which a plane cuts the triangles ahead of the sonar; return the number of parts."""
    node = 0
    while node < mesh.skip.size:
        if not _crossed(mesh.low[node], mesh.high[node], view, reach):
            node = mesh.skip[node]
            continue
        for k in range(mesh.first[node], mesh.first[node] + mesh.held[node]):
            parts = _cut_triangle(mesh.corners[k], first_body + k, view, screen, parts)
        node += 1
    return parts


@fused
def _crossed(low, high, view, reach):
    """Whether a plane may cut a box ahead of the sonar, within reach."""
    cx, cy = 0.5 * (low[0] + high[0]) - view.x, 0.5 * (low[1] + high[1]) - view.y
    hx, hy = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])
    wide, long = hx * abs(view.ey) + hy * abs(view.ex), hx * abs(view.ex) + hy * abs(view.ey)
    across, along = cx * view.ey - cy * view.ex, cx * view.ex + cy * view.ey
    return abs(across) <= wide and -long <= along <= reach + long


@fused
def _cut_triangle(corners, body, view, screen, parts):
    """Add the line in which the plane cuts one triangle, if it does."""
    ends = 0
    for k in range(3):
        following = k + 1 if k < 2 else 0
        here, there = _across(corners[k], view), _across(corners[following], view)
        if (here < 0.0) == (there < 0.0):
            continue
        # From the negative side to the positive: both triangles at an edge find the same point to the last bit.
        a, b = (k, following) if here < 0.0 else (following, k)
        below, above = min(here, there), max(here, there)
        share = below / (below - above)
        px = corners[a, 0] + (corners[b, 0] - corners[a, 0]) * share - view.x
        py = corners[a, 1] + (corners[b, 1] - corners[a, 1]) * share - view.y
        screen.line[parts, 2 * ends] = px * view.ex + py * view.ey
        screen.line[parts, 2 * ends + 1] = corners[a, 2] + (corners[b, 2] - corners[a, 2]) * share - view.z
        ends += 1
        if ends == 2:
            break
    if ends < 2 or not _keep_ahead(screen.line[parts]):
        return parts
    line = screen.line[parts]
    one, other = math.atan2(line[1], line[0]), math.atan2(line[3], line[2])
    if abs(one - other) <= SAME:
        return parts  # seen edge-on
    screen.body[parts], screen.low[parts], screen.high[parts] = body, min(one, other), max(one, other)
    return parts + 1


@fused
def _across(corner, view):
    """Signed distance of a corner from the plane."""
    return (corner[0] - view.x) * view.ey - (corner[1] - view.y) * view.ex


@fused
def _keep_ahead(line):
    """Cut off what lies behind the sonar; whether anything is left."""
    if line[0] <= 0.0 and line[2] <= 0.0:
        return False
    if line[0] < 0.0:
        line[1] -= line[0] * (line[3] - line[1]) / (line[2] - line[0])
        line[0] = 0.0
    elif line[2] < 0.0:
        line[3] -= line[2] * (line[1] - line[3]) / (line[0] - line[2])
        line[2] = 0.0
    return True


@kernel
def _fill_cells(problem, view, screen, solid_parts, parts):
    """Divide the screen at the ends and feet of parts, find the nearest in every cell; return the number of cells."""
    cells = _divide(screen, solid_parts, parts)
    for p in range(parts):
        part = load_part(problem.solids, problem.mesh, view, screen.body[p], screen.line[p])
        first = _first_cell(screen.edge[: cells + 1], screen.low[p])
        ends = screen.low[p], screen.high[p]
        edge, cosine, sine = screen.edge, screen.cosine, screen.sine
        _keep_nearest(p, part, first, cells, ends, edge, cosine, sine, screen.part, screen.distance, screen.incidence)
    for p in range(parts):
        part = load_part(problem.solids, problem.mesh, view, screen.body[p], screen.line[p])
        first = _first_cell(screen.edge[: cells + 1], screen.low[p])
        last, edge, cosine, sine = screen.high[p], screen.edge, screen.cosine, screen.sine
        _measure(p, part, first, cells, last, edge, cosine, sine, screen.part, screen.near, screen.far)
    return cells


@fused
def _divide(screen, solid_parts, parts):
    """Lay the edges of the cells; return the number of cells, all empty."""
    count = 0
    for p in range(solid_parts):
        middle, half = 0.5 * (screen.low[p] + screen.high[p]), 0.5 * (screen.high[p] - screen.low[p])
        half *= 1.0 - EDGE
        for facet in range(FACETS + 1):
            screen.edge[count] = middle - half * SPREAD[facet]
            count += 1
    for p in range(solid_parts, parts):
        # Slant range falls towards the foot of the perpendicular and grows beyond it.
        foot = min(max(_foot(screen.line[p]), screen.low[p]), screen.high[p])
        screen.edge[count], screen.edge[count + 1], screen.edge[count + 2] = screen.low[p], foot, screen.high[p]
        count += 3
    if parts > 1:
        screen.edge[:count].sort()
        count = _merged(screen.edge[:count])
    _directions(screen.edge[:count], screen.cosine, screen.sine)
    screen.part[: count - 1] = NOBODY
    screen.distance[: count - 1] = math.inf
    return count - 1


@fused
def _foot(line):
    """Launch angle at right angles to a line."""
    dx, dz = line[2] - line[0], line[3] - line[1]
    return math.atan2(-dx, dz) if dz >= 0.0 else math.atan2(dx, -dz)


@fused
def _directions(edge, cosine, sine):
    for k in range(edge.size):
        cosine[k], sine[k] = math.cos(edge[k]), math.sin(edge[k])


@fused
def _keep_nearest(p, part, first, cells, ends, edge, cosine, sine, nearest, distance, incidence):
    """Enter a part in the cells where nothing nearer is; where two touch the first is heard."""
    low, high = ends
    cell = first
    while cell < cells and edge[cell] < high:
        if low < 0.5 * (edge[cell] + edge[cell + 1]) < high:
            c, s = halfway(cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1])
            here, cos_incidence = meet_part(part, c, s)
            if here < distance[cell]:
                nearest[cell], distance[cell], incidence[cell] = p, here, cos_incidence
        cell += 1


@fused
def _measure(p, part, first, cells, high, edge, cosine, sine, nearest, near, far):
    """Measure the distances to a part along the edges of the cells in which it is the nearest."""
    cell = first
    while cell < cells and edge[cell] < high:
        if nearest[cell] == p:
            near[cell], _ = meet_part(part, cosine[cell], sine[cell])
            far[cell], _ = meet_part(part, cosine[cell + 1], sine[cell + 1])
        cell += 1


@fused
def _first_cell(edge, low):
    """Cell in which a part begins."""
    return max(np.searchsorted(edge, low, side="right") - 1, 0)


@fused
def halfway(c_from, s_from, c_to, s_to):
    """Direction (cosine, sine) between two others."""
    c, s = c_from + c_to, s_from + s_to
    per_norm = 1.0 / math.sqrt(c * c + s * s)
    return c * per_norm, s * per_norm


@fused
def _merged(edge):
    """Drop edges that follow too closely, in place; return how many are left."""
    kept = 0
    for k in range(1, edge.size):
        if edge[k] - edge[kept] > SAME:
            kept += 1
            edge[kept] = edge[k]
    return kept + 1


@fused
def load_part(solids, mesh, view, body, line):
    """Take out of the tables what a part is like, from where the sonar stands."""
    k = body - solids.shape.size
    if k >= 0:
        level = mesh.normal[k, 0] * view.ex + mesh.normal[k, 1] * view.ey
        dx, dz = line[2] - line[0], line[3] - line[1]
        return Part(TRIANGLE, line[0], 0.0, line[1], dx, 0.0, dz, 0.0, 0.0, 0.0, level, mesh.normal[k, 2])
    return Part(
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
    )


@fused
def meet_part(part, c, s):
    """Distance to a part in the direction (c, s), and the cosine of the incidence there; infinite if missed."""
    if part.kind == TRIANGLE:
        distance = (part.x * part.az - part.z * part.ax) / (c * part.az - s * part.ax)
        # Sheets are heard from both sides.
        return (distance if distance > 0.0 else math.inf), abs(c * part.level_x + s * part.level_y)
    dx, dy = c * part.level_x, c * part.level_y
    if part.kind == SPHERE:
        distance, _ = cross_sphere(part.x, part.y, part.z, part.radius, dx, dy, s)
        inwards = (part.x * dx + part.y * dy + part.z * s - distance) / part.radius
        return (distance if distance > 0.0 else math.inf), inwards
    distance, face, _, _ = cross_frustum(
        part.x, part.y, part.z, part.ax, part.ay, part.az, part.length, part.radius, part.taper, dx, dy, s
    )
    if not 0.0 < distance < math.inf:
        return math.inf, 0.0
    px, py, pz = distance * dx - part.x, distance * dy - part.y, distance * s - part.z
    nx, ny, nz = frustum_normal(px, py, pz, part.ax, part.ay, part.az, part.radius, part.taper, face)
    return distance, -(nx * dx + ny * dy + nz * s)


@fused
def hidden_slopes(screen, cells):
    """Slopes between which any body may hide the bed."""
    if cells <= 0:
        return NEVER, -NEVER
    low, high = screen.edge[0], screen.edge[cells]
    # The outermost cells of a body end a hair inside it.
    return (
        math.tan(low) * (1.0 + math.copysign(EDGE, -low)) if low > DOWN else -NEVER,
        math.tan(high) * (1.0 + math.copysign(EDGE, high)) if high < UP else NEVER,
    )


class Cover(NamedTuple):
    """What of a screen the bed behind it needs to know; arrays as long as its edges."""

    edge: NDArray[np.float64]
    near: NDArray[np.float64]
    far: NDArray[np.float64]
    part: NDArray[np.int64]


@fused
def cover_of(screen, cells):
    """Return what hides the bed; without cells, nothing does."""
    n = cells + 1 if cells > 0 else 0
    return Cover(screen.edge[:n], screen.near[:n], screen.far[:n], screen.part[:n])


@fused
def next_open(cover, surface, start, stop):
    """Return the first stretch of launch angles in [start, stop] in which a segment of the bed is not hidden."""
    edge, near, far, part = cover.edge, cover.near, cover.far, cover.part
    cell = np.searchsorted(edge, start, side="right") - 1
    while start < stop and _hides(edge, near, far, part, cell, surface, start, stop):
        cell += 1
        start = edge[cell]
    end = min(start, stop)
    while end < stop:
        cell += 1
        end = edge[cell] if cell < edge.size else stop
        if _hides(edge, near, far, part, cell, surface, end, stop):
            break
    return min(start, stop), min(end, stop)


@fused
def _hides(edge, near, far, part, cell, surface, start, stop):
    """Whether what is nearest in a cell lies before the bed, in the part of the cell within [start, stop]."""
    if cell < 0 or cell >= edge.size - 1 or part[cell] == NOBODY:
        return False
    low, high = edge[cell], edge[cell + 1]
    angle = 0.5 * (max(start, low) + min(stop, high))
    # Along a straight line one over the distance is linear in the direction.
    nearness = (math.sin(high - angle) / near[cell] + math.sin(angle - low) / far[cell]) / math.sin(high - low)
    return nearness * surface.offset < math.sin(angle) - surface.slope * math.cos(angle)
