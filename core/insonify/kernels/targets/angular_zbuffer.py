"""Angular z-buffer of one plane: cells of launch angle, each with the target that is nearest in it.

A plane cuts a convex body in one figure and a triangle in one straight line, its *primitives*. Between neighbouring
ends of primitives the same ones lie before and behind one another, so that the nearest in the middle of a cell is the
nearest in all of it.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import INTEGER, inlined_uncounted, kernel, kernel_separate
from insonify.kernels.common.search import last_not_above
from insonify.kernels.common.types import Mesh, Solids
from insonify.kernels.geometry.cross_sections import (
    may_cut_solid,
    meet_solid_by_rays,
    section_solid,
    solid_distance_bound,
)
from insonify.kernels.geometry.solids import distance_to_solid, reach_of_solid
from insonify.kernels.targets.apparent_targets import (
    FIELDS,
    apply_apparent_sources,
    arrival_direction,
    load_apparent_source,
    plane_from_source,
)
from insonify.kernels.targets.primitives import (
    bisect_directions,
    intersect_primitive,
    load_primitive,
    measure_directions,
    meet_primitive,
    nearest_distance,
    perpendicular_angle,
)

FACETS = 64  # cells of a convex body alone in its plane, closer together towards its edges
RIMS = 6  # rims that a plane cuts of one body, at most four, and room to find them
EDGE = 1e-9  # share of an interval by which the outermost cells of a body end inside it, to be sure to meet it
CROSSED = 1e-5  # share of a distance by which a primitive must come before another to cross it
SPREAD = np.cos(np.pi * np.arange(FACETS + 1) / FACETS)
SAME = 1e-9  # rad; ends of primitives closer together are one
NO_PRIMITIVE = -1


@inlined_uncounted
def meet_body(body, count, normals, distance, incidence, lean):
    """Slant range of a body along many rays of its plane, and the inward normal there, as parts within the plane.

    ``distance`` and ``incidence`` enter as cosine and sine of the launch angles, which are not needed afterwards.
    """
    # The arithmetic of `meet_primitive` without branches, which would keep the compiler from its vector units: ray by
    # ray, the z-buffer of a pipe takes four times as long.
    source = body.source
    if source.bent:
        for i in range(count):
            distance[i], incidence[i] = arrival_direction(source, distance[i], incidence[i])
    meet_solid_by_rays(body, count, normals, distance, incidence, lean)
    if source.bent:
        for i in range(count):
            distance[i] = source.offset + source.gauge * distance[i]


class AngularZbuffer(NamedTuple):
    """Primitives of one plane, then cells of launch angle; arrays are longer than their numbers."""

    body: NDArray[np.int64]  # row of the solids, or beyond them the triangle, of each primitive
    low: NDArray[np.float64]  # launch angle above the horizontal at which the primitive begins, rad
    high: NDArray[np.float64]  # and ends
    line: NDArray[np.float64]  # (primitives, 4) of a triangle: ground range and height above the sonar of its ends
    least: NDArray[np.float64]  # slant range before which nothing of a body lies, m; 0 of a triangle
    most: NDArray[np.float64]  # and beyond which nothing of it lies, m; infinite of a triangle
    source: NDArray[np.float64]  # (primitives, 11) apparent sources, in water that refracts
    rim: NDArray[np.float64]  # (bodies, 6) of a body: launch angles at which one face ends and another begins
    first: NDArray[np.int64]  # cell in which a primitive begins
    edge: NDArray[np.float64]  # launch angles at which cells begin; the last one ends the last cell
    cosine: NDArray[np.float64]  # of the edges
    sine: NDArray[np.float64]
    nearest: NDArray[np.int64]  # primitive nearest in each cell, or NO_PRIMITIVE
    distance: NDArray[np.float64]  # to it along the middle of the cell, infinite where there is none
    incidence: NDArray[np.float64]  # cosine of the incidence there
    lean: NDArray[np.float64]  # part of the inward normal there at right angles to the ray, upwards in the plane
    near: NDArray[np.float64]  # distance to it along the edge where the cell begins
    far: NDArray[np.float64]  # and where it ends
    # One over the distance, nearly so if the primitive is curved: nearness_cosine · cos θ + nearness_sine · sin θ.
    nearness_cosine: NDArray[np.float64]
    nearness_sine: NDArray[np.float64]
    rays: NDArray[np.float64]  # (3, cells) work space: what `meet_body` measures along the rays to one body


def empty_zbuffer(solids: Solids, mesh: Mesh) -> AngularZbuffer:
    """Make room for all that a plane may cut of a scene."""
    bodies, triangles = solids.shape.size, mesh.target.size
    primitives, cells = bodies + triangles, bodies * (FACETS + 3 + RIMS) + 5 * triangles + 1
    low, high = np.zeros((2, primitives))
    edge, cosine, sine, distance, incidence, lean, near, far, nearness_cosine, nearness_sine = np.zeros((10, cells))
    body, first, nearest = np.zeros(primitives, np.int64), np.zeros(primitives, np.int64), np.zeros(cells, np.int64)
    line, source, rim = np.zeros((primitives, 4)), np.zeros((primitives, FIELDS)), np.zeros((bodies, RIMS))
    least, most = np.zeros((2, primitives))
    return AngularZbuffer(
        body, low, high, line, least, most, source, rim, first, edge, cosine, sine, nearest, distance, incidence, lean,
        near, far, nearness_cosine, nearness_sine, np.zeros((3, cells)),
    )  # fmt: skip


@inlined_uncounted
def fill_zbuffer(arrays, plane, sector, reach, grid, table, zbuffer):
    """Collect the primitives that a plane cuts and find the nearest for every launch angle."""
    primitives = _cut_solids(arrays.solids, plane, reach, plane.z - arrays.bed.low, zbuffer)
    solid_primitives = primitives
    if arrays.mesh.target.size > 0:
        primitives = _cut_mesh(arrays.mesh, arrays.solids.shape.size, plane, sector.bent, reach, zbuffer, primitives)
    if sector.bent and primitives > 0:
        solid_primitives, primitives = apply_apparent_sources(
            arrays, plane, sector.angle == 0.0, table, grid, zbuffer, solid_primitives, primitives
        )
    if primitives == 0:
        return 0
    if sector.angle > 0.0:
        _bound_ranges(arrays.solids, plane, sector.bent, zbuffer, solid_primitives, primitives)
    return _fill_cells(arrays.solids, arrays.mesh, plane, sector.bent, zbuffer, solid_primitives, primitives)


@inlined_uncounted
def _bound_ranges(solids, plane, bent, zbuffer, solid_primitives, primitives):
    """Bound the slant ranges at which each body lies, in or beside the plane."""
    for p in range(solid_primitives):
        source = load_apparent_source(bent, zbuffer.source[p])
        seen_from = plane_from_source(source, plane) if bent else plane
        least = distance_to_solid(solids, zbuffer.body[p], seen_from.x, seen_from.y, seen_from.z)
        most = reach_of_solid(solids, zbuffer.body[p], seen_from.x, seen_from.y, seen_from.z)
        zbuffer.least[p] = source.offset + source.gauge * least if bent else least
        zbuffer.most[p] = source.offset + source.gauge * most if bent else most
    zbuffer.least[solid_primitives:primitives], zbuffer.most[solid_primitives:primitives] = 0.0, math.inf


@inlined_uncounted
def _cut_solids(solids, plane, reach, height, zbuffer):
    """Add the cross-sections of convex bodies; return the number of primitives."""
    primitives = 0
    for k in range(solids.shape.size):
        if may_cut_solid(solids, k, plane, reach, height):
            is_cut, low, high = section_solid(solids, k, plane, zbuffer.rim[primitives])
            if is_cut:
                zbuffer.body[primitives], zbuffer.low[primitives], zbuffer.high[primitives] = k, low, high
                primitives += 1
    return primitives


@kernel_separate(INTEGER)
def _cut_mesh(mesh, first_body, plane, bent, reach, zbuffer, primitives):
    """Add the lines in which a plane cuts the triangles ahead of the sonar to the primitives of a z-buffer."""
    # Where sound is straight, triangles of closed bodies that face away are left out: others lie before them.
    node = 0
    while node < mesh.skip.size:
        if not _may_cut_box(mesh.low[node], mesh.high[node], plane, reach):
            node = mesh.skip[node]
            continue
        for k in range(mesh.first[node], mesh.first[node] + mesh.leaf_size[node]):
            if mesh.closed[k] and not bent and not _faces(mesh.corners[k, 0], mesh.normal[k], plane):
                continue
            primitives = _cut_triangle(mesh.corners[k], first_body + k, plane, zbuffer, primitives)
        node += 1
    return primitives


@inlined_uncounted
def _faces(corner, normal, plane):
    """Whether a triangle is seen from outside, by one of its corners and its normal."""
    x, y, z = plane.x - corner[0], plane.y - corner[1], plane.z - corner[2]
    return x * normal[0] + y * normal[1] + z * normal[2] > 0.0


@inlined_uncounted
def _may_cut_box(low, high, plane, reach):
    """Whether a plane may cut a box ahead of the sonar, within reach."""
    cx, cy = 0.5 * (low[0] + high[0]) - plane.x, 0.5 * (low[1] + high[1]) - plane.y
    hx, hy = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1])
    wide, long = hx * abs(plane.ey) + hy * abs(plane.ex), hx * abs(plane.ex) + hy * abs(plane.ey)
    across, along = cx * plane.ey - cy * plane.ex, cx * plane.ex + cy * plane.ey
    return abs(across) <= wide and -long <= along <= reach + long


@inlined_uncounted
def _cut_triangle(corners, body, plane, zbuffer, primitives):
    """Add the line in which the plane cuts one triangle, if it does; return the number of primitives."""
    ends = 0
    for k in range(3):
        following = k + 1 if k < 2 else 0
        here, there = _signed_distance(corners[k], plane), _signed_distance(corners[following], plane)
        if (here < 0.0) == (there < 0.0):
            continue
        # From the negative side to the positive: both triangles at an edge find the same point to the last bit.
        a, b = (k, following) if here < 0.0 else (following, k)
        below, above = min(here, there), max(here, there)
        share = below / (below - above)
        px = corners[a, 0] + (corners[b, 0] - corners[a, 0]) * share - plane.x
        py = corners[a, 1] + (corners[b, 1] - corners[a, 1]) * share - plane.y
        zbuffer.line[primitives, 2 * ends] = px * plane.ex + py * plane.ey
        zbuffer.line[primitives, 2 * ends + 1] = corners[a, 2] + (corners[b, 2] - corners[a, 2]) * share - plane.z
        ends += 1
        if ends == 2:
            break
    if ends < 2 or not _clip_ahead(zbuffer.line[primitives]):
        return primitives
    line = zbuffer.line[primitives]
    one, other = math.atan2(line[1], line[0]), math.atan2(line[3], line[2])
    if abs(one - other) <= SAME:
        return primitives  # seen edge-on
    zbuffer.body[primitives], zbuffer.low[primitives], zbuffer.high[primitives] = body, min(one, other), max(one, other)
    return primitives + 1


@inlined_uncounted
def _signed_distance(corner, plane):
    """Signed distance of a corner from the plane."""
    return (corner[0] - plane.x) * plane.ey - (corner[1] - plane.y) * plane.ex


@inlined_uncounted
def _clip_ahead(line):
    """Cut off the part of a line behind the sonar; return whether anything is left."""
    if line[0] <= 0.0 and line[2] <= 0.0:
        return False
    if line[0] < 0.0:
        line[1] -= line[0] * (line[3] - line[1]) / (line[2] - line[0])
        line[0] = 0.0
    elif line[2] < 0.0:
        line[3] -= line[2] * (line[1] - line[3]) / (line[0] - line[2])
        line[2] = 0.0
    return True


@kernel_separate(INTEGER)
def _fill_cells(solids, mesh, plane, bent, zbuffer, solid_primitives, primitives):
    """Divide launch angles where primitives end, turn or cross and find the nearest in every cell; return the cells."""
    edges = _lay_edges(zbuffer, solid_primitives, primitives)
    cells = 0
    for crossings_known in (False, True):
        cells = _sort_edges(zbuffer, edges)
        _find_nearest(solids, mesh, plane, bent, zbuffer, solid_primitives, primitives, cells)
        edges = cells + 1
        if not crossings_known and primitives > 1:
            edges = _add_crossings(solids, mesh, plane, bent, zbuffer, solid_primitives, primitives, cells)
        if edges == cells + 1:
            break
    _fit_nearness(cells, zbuffer)
    return cells


@inlined_uncounted
def _lay_edges(zbuffer, solid_primitives, primitives):
    """Lay the edges of all primitives, in no order; return their number."""
    count = 0
    for p in range(solid_primitives):
        middle, half = 0.5 * (zbuffer.low[p] + zbuffer.high[p]), 0.5 * (zbuffer.high[p] - zbuffer.low[p])
        half *= 1.0 - EDGE
        for facet in range(FACETS + 1):
            zbuffer.edge[count] = middle - half * SPREAD[facet]
            count += 1
        # Incidence jumps at a rim.
        for angle in zbuffer.rim[p]:
            if abs(angle - middle) < half:
                zbuffer.edge[count] = angle
                count += 1
    for p in range(solid_primitives, primitives):
        # Slant range falls towards the foot of the perpendicular and grows beyond it.
        foot = min(max(perpendicular_angle(zbuffer.line[p]), zbuffer.low[p]), zbuffer.high[p])
        zbuffer.edge[count], zbuffer.edge[count + 1], zbuffer.edge[count + 2] = zbuffer.low[p], foot, zbuffer.high[p]
        count += 3
    return count


@inlined_uncounted
def _sort_edges(zbuffer, edges):
    """Put edges in order if they are not; return the number of cells between them, all empty."""
    edge, count = zbuffer.edge, edges
    for k in range(1, edges):
        if edge[k] < edge[k - 1]:
            _sort(edge, edges)
            count = _merge_close_edges(edge, edges)
            break
    measure_directions(edge[:count], zbuffer.cosine, zbuffer.sine)
    for k in range(count - 1):
        zbuffer.nearest[k], zbuffer.distance[k] = NO_PRIMITIVE, math.inf
    return count - 1


@kernel
def _sort(edge, edges):
    """Sort the first edges in place."""
    edge[:edges].sort()


@inlined_uncounted
def _find_nearest(solids, mesh, plane, bent, zbuffer, solid_primitives, primitives, cells):
    """Find the primitive that is nearest in every cell and the distances to it."""
    edge = zbuffer.edge[: cells + 1]
    for p in range(primitives):
        source = load_apparent_source(bent, zbuffer.source[p])
        primitive = load_primitive(solids, mesh, plane, zbuffer.body[p], zbuffer.line[p], source)
        first = zbuffer.first[p] = max(last_not_above(edge, zbuffer.low[p]), 0)
        if p < solid_primitives:
            last = min(last_not_above(edge, zbuffer.high[p]) + 1, cells)
            _keep_nearer_body(p, primitive, first, last - first, zbuffer)
        else:
            _keep_nearer_triangle(p, primitive, cells, zbuffer)
    for p in range(solid_primitives, primitives):
        source = load_apparent_source(bent, zbuffer.source[p])
        primitive = load_primitive(solids, mesh, plane, zbuffer.body[p], zbuffer.line[p], source)
        _measure_edges(p, primitive, cells, zbuffer)


@inlined_uncounted
def _keep_nearer_body(p, body, first, count, zbuffer):
    """Enter a body in the cells where it is nearer than their primitive: its distances along middles and edges."""
    # Bodies have many cells and are met by all rays at once; triangles have few and are met ray by ray. Rays that need
    # not meet the body are followed too, because all of them at once take less time than one by one.
    edge, low, high = zbuffer.edge[first:], zbuffer.low[p], zbuffer.high[p]
    cosine, sine = zbuffer.cosine[first:], zbuffer.sine[first:]
    here, cos_incidence, leaning = zbuffer.rays[0], zbuffer.rays[1], zbuffer.rays[2]
    nearest, distance = zbuffer.nearest[first:], zbuffer.distance[first:]
    for k in range(count):
        here[k], cos_incidence[k] = bisect_directions(cosine[k], sine[k], cosine[k + 1], sine[k + 1])
    meet_body(body, count, True, here, cos_incidence, leaning)
    for k in range(count):
        middle = 0.5 * (edge[k] + edge[k + 1])
        here[k] = here[k] if (low < middle) & (middle < high) else math.inf
    # Few arrays in each pass, so that the compiler can use its vector units.
    _replace_nearer(count, here, distance, cos_incidence, zbuffer.incidence[first:])
    _replace_nearer(count, here, distance, leaning, zbuffer.lean[first:])
    for k in range(count):
        nearest[k] = p if here[k] < distance[k] else nearest[k]
    for k in range(count):
        distance[k] = here[k] if here[k] < distance[k] else distance[k]
    for k in range(count + 1):
        here[k], cos_incidence[k] = cosine[k], sine[k]
    meet_body(body, count + 1, False, here, cos_incidence, leaning)
    _replace_of(p, count, nearest, here, zbuffer.near[first:])
    _replace_of(p, count, nearest, here[1:], zbuffer.far[first:])


@inlined_uncounted
def _replace_nearer(count, here, distance, values, kept):
    """Replace the values of cells in which something is nearer than their primitive."""
    for k in range(count):
        kept[k] = values[k] if here[k] < distance[k] else kept[k]


@inlined_uncounted
def _replace_of(p, count, nearest, values, kept):
    """Replace the values of cells in which a primitive is the nearest."""
    for k in range(count):
        kept[k] = values[k] if nearest[k] == p else kept[k]


@inlined_uncounted
def _keep_nearer_triangle(p, triangle, cells, zbuffer):
    """Enter a triangle in the cells where it is nearer than their primitive; of two at one distance the first stays."""
    edge, cosine, sine = zbuffer.edge, zbuffer.cosine, zbuffer.sine
    nearest, distance, incidence, lean = zbuffer.nearest, zbuffer.distance, zbuffer.incidence, zbuffer.lean
    low, high, cell = zbuffer.low[p], zbuffer.high[p], zbuffer.first[p]
    while cell < cells and edge[cell] < high:
        if low < 0.5 * (edge[cell] + edge[cell + 1]) < high:
            c, s = bisect_directions(cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1])
            here, cos_incidence, leaning = meet_primitive(triangle, c, s)
            if here < distance[cell]:
                nearest[cell], distance[cell], incidence[cell], lean[cell] = p, here, cos_incidence, leaning
        cell += 1


@inlined_uncounted
def _measure_edges(p, triangle, cells, zbuffer):
    """Measure the distances to a triangle along the edges of the cells in which it is the nearest."""
    edge, cosine, sine, near, far = zbuffer.edge, zbuffer.cosine, zbuffer.sine, zbuffer.near, zbuffer.far
    nearest, first, high = zbuffer.nearest, zbuffer.first[p], zbuffer.high[p]
    cell = first
    while cell < cells and edge[cell] < high:
        if nearest[cell] == p:
            if cell > first and nearest[cell - 1] == p:
                near[cell] = far[cell - 1]
            else:
                near[cell], _ = intersect_primitive(triangle, cosine[cell], sine[cell])
            far[cell], _ = intersect_primitive(triangle, cosine[cell + 1], sine[cell + 1])
        cell += 1


@inlined_uncounted
def _add_crossings(solids, mesh, plane, bent, zbuffer, solid_primitives, primitives, cells):
    """Add an edge wherever a primitive comes before the one that is nearest in a cell's middle; return the edges."""
    edges = cells + 1
    for p in range(primitives):
        if p >= solid_primitives:
            least = nearest_distance(zbuffer.line[p])
        else:
            least = 0.0 if bent else solid_distance_bound(solids, zbuffer.body[p], plane)
        if _is_behind(p, least, cells, zbuffer):
            continue
        source = load_apparent_source(bent, zbuffer.source[p])
        primitive = load_primitive(solids, mesh, plane, zbuffer.body[p], zbuffer.line[p], source)
        edges = _add_crossings_of(p, primitive, least, cells, zbuffer, edges)
    return edges


@inlined_uncounted
def _is_behind(p, least, cells, zbuffer):
    """Whether a primitive no point of which is nearer than ``least`` lies behind all that is nearest in its cells."""
    edge, nearest, near, far = zbuffer.edge, zbuffer.nearest, zbuffer.near, zbuffer.far
    cell, high = zbuffer.first[p], zbuffer.high[p]
    while cell < cells and edge[cell] < high:
        if nearest[cell] != p and least < max(near[cell], far[cell]):
            return False
        cell += 1
    return True


@inlined_uncounted
def _add_crossings_of(p, primitive, least, cells, zbuffer, edges):
    """Add an edge wherever one primitive crosses the nearest one of a cell; return the number of edges."""
    edge, cosine, sine = zbuffer.edge, zbuffer.cosine, zbuffer.sine
    nearest, near, middle, far = zbuffer.nearest, zbuffer.near, zbuffer.distance, zbuffer.far
    low, high, cell = zbuffer.low[p], zbuffer.high[p], zbuffer.first[p]
    while cell < cells and edge[cell] < high:
        covers = low < 0.5 * (edge[cell] + edge[cell + 1]) < high
        if covers and nearest[cell] != p and least < max(near[cell], far[cell]):
            c, s = bisect_directions(cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1])
            here, half = intersect_primitive(primitive, c, s)[0], 0.5 * (edge[cell + 1] - edge[cell])
            for k in range(2):
                there = intersect_primitive(primitive, cosine[cell + k], sine[cell + k])[0]
                other = near[cell] if k == 0 else far[cell]
                if there < other * (1.0 - CROSSED) and edges < edge.size:
                    # One over the distance along a straight line is linear in the direction, and so is its lead.
                    lead, lag = 1.0 / there - 1.0 / other, 1.0 / middle[cell] - 1.0 / here
                    turned = math.atan2(lead * math.sin(half), lead * math.cos(half) + lag)
                    edge[edges] = edge[cell] + turned if k == 0 else edge[cell + 1] - turned
                    edges += 1
        cell += 1
    return edges


@inlined_uncounted
def _fit_nearness(cells, zbuffer):
    """Fit one over the distance to what is nearest in each cell as a linear function of the direction; 0 if empty."""
    nearest, cosine, sine, near, far = zbuffer.nearest, zbuffer.cosine, zbuffer.sine, zbuffer.near, zbuffer.far
    nearness_cosine, nearness_sine = zbuffer.nearness_cosine, zbuffer.nearness_sine
    for cell in range(cells):
        c_low, s_low, c_high, s_high = cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1]
        share, filled = 1.0 / (s_high * c_low - c_high * s_low), nearest[cell] != NO_PRIMITIVE
        per_near, per_far = share / near[cell], share / far[cell]
        nearness_cosine[cell] = s_high * per_near - s_low * per_far if filled else 0.0
        nearness_sine[cell] = c_low * per_far - c_high * per_near if filled else 0.0


@inlined_uncounted
def cell_towards(cosine, sine, cells, level, height):
    """Cell of a z-buffer in which a place lies."""
    low, high = -1, cells + 1
    # Cross products tell on which side of an edge a place ahead lies.
    while high - low > 1:
        middle = (low + high) >> 1
        if cosine[middle] * height >= sine[middle] * level:
            low = middle
        else:
            high = middle
    return low if low < cells else -1


@inlined_uncounted
def _merge_close_edges(edge, edges):
    """Drop edges that follow too closely, in place; return how many are left."""
    kept = 0
    for k in range(1, edges):
        if edge[k] - edge[kept] > SAME:
            kept += 1
            edge[kept] = edge[k]
    return kept + 1
