"""Echoes of targets, facet by facet.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import NOTHING, inlined_uncounted, kernel_separate
from insonify.kernels.geometry.cross_sections import NEVER
from insonify.kernels.sweep.facets import Facet, deposit_facet
from insonify.kernels.sweep.partial_segments import FINE
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.apparent_targets import ApparentSource, load_apparent_source, rays_apart
from insonify.kernels.targets.primitives import Primitive, bisect_directions, intersect_primitive, load_primitive

MOST_FACETS = 64.0
HALVINGS = 10  # that find where a facet comes out of the bed


class BedHorizon(NamedTuple):
    """A profile of the bed with its running horizon, which may hide targets."""

    x: NDArray[np.float64]  # ground range of the knots, m
    z: NDArray[np.float64]  # height above the sonar, m
    slope: NDArray[np.float32]  # greatest launch slope of the bed up to each knot
    knots: int


class TargetCell(NamedTuple):
    """The target that is nearest in one cell of a z-buffer."""

    primitive: Primitive
    source: ApparentSource
    body: int  # row of the solids, or beyond them the triangle
    target: int  # index of the declared target
    row: int  # of the reflectivity table
    material: tuple[float, float, float]  # that row
    low: float  # launch angles between which the cell lies, rad
    high: float
    facets: int  # into which the cell is divided
    knot: int  # of the bed, at or before the cell's middle
    bounds: tuple[float, float]  # slant ranges before and beyond which nothing of the body lies, m


@inlined_uncounted
def deposit_targets(profile, knots, horizon, arrays, sector, plane, zbuffer, cells, bins):
    """Spread the echoes of the targets that one plane cuts over the range bins, less what the bed hides of them."""
    bed, bodies = BedHorizon(profile.x, profile.z, horizon, knots), (arrays.solids, arrays.mesh, arrays.reflectivity)
    # What is not needed is not handed over.
    _deposit_cells(bed, bodies, arrays.pattern, arrays.law, arrays.bin_length, sector, plane, zbuffer, cells, bins)


@kernel_separate(NOTHING)
def _deposit_cells(bed, bodies, pattern, law, bin_length, sector, plane, zbuffer, cells, bins):
    """Spread the echoes of the targets in all cells of a z-buffer over the range bins."""
    # Arrays are taken out of their tuples before the loop: doing so costs more than a facet.
    solids, mesh, table = bodies
    edge, cosine, sine, nearest = zbuffer.edge, zbuffer.cosine, zbuffer.sine, zbuffer.nearest
    near, distance, far, incidence = zbuffer.near, zbuffer.distance, zbuffer.far, zbuffer.incidence
    sources, least, most, knot = zbuffer.source, zbuffer.least, zbuffer.most, -1
    for cell in range(cells):
        if nearest[cell] == NO_PRIMITIVE:
            continue
        row = primitive_material(solids, mesh, zbuffer, nearest[cell])
        source = load_apparent_source(sector.bent, sources[nearest[cell]])
        gain, material = source.gain, (table[row, 0], table[row, 1], table[row, 2])
        c, s = bisect_directions(cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1])
        bounds = least[nearest[cell]], most[nearest[cell]]
        arc = rays_apart(source, distance[cell])
        facet = Facet(edge[cell], edge[cell + 1], c, s, near[cell], distance[cell], far[cell], incidence[cell], arc)
        facets = _facet_count(facet)
        # Neighbouring cells mostly meet neighbouring places.
        farthest = max(facet.near * cosine[cell], facet.far * cosine[cell + 1])
        knot = knot_before(bed, farthest, knot)
        ridge = horizon_at(bed, knot, farthest)
        if facets == 1 and ridge * cosine[cell] <= sine[cell]:
            deposit_facet(facet, bounds, gain, material, sector, pattern, law, bin_length, bins)
            continue
        body, line = zbuffer.body[nearest[cell]], zbuffer.line[nearest[cell]]
        primitive = load_primitive(solids, mesh, plane, body, line, source)
        for k in range(facets):
            facet = visible_facet(primitive, edge[cell], edge[cell + 1], k, facets, bed, knot)
            deposit_facet(facet, bounds, gain, material, sector, pattern, law, bin_length, bins)


@inlined_uncounted
def load_cell(cell, bodies, plane, bent, zbuffer, bed, knot):
    """Load the target in a cell of a z-buffer that is not empty; ``knot`` is where the search for the bed's begins."""
    solids, mesh, table = bodies
    p = zbuffer.nearest[cell]
    body, row = zbuffer.body[p], primitive_material(solids, mesh, zbuffer, p)
    source = load_apparent_source(bent, zbuffer.source[p])
    primitive = load_primitive(solids, mesh, plane, body, zbuffer.line[p], source)
    facet = cell_facet(zbuffer, cell, source)
    material, target = (table[row, 0], table[row, 1], table[row, 2]), target_of_body(solids, mesh, body)
    low, high, knot = zbuffer.edge[cell], zbuffer.edge[cell + 1], knot_before(bed, facet.centre * facet.cosine, knot)
    facets, bounds = _facet_count(facet), (zbuffer.least[p], zbuffer.most[p])
    return TargetCell(primitive, source, body, target, row, material, low, high, facets, knot, bounds)


@inlined_uncounted
def cell_facet(zbuffer, cell, source):
    """Facet that fills a cell of a z-buffer."""
    cosine, sine, distance = zbuffer.cosine, zbuffer.sine, zbuffer.distance[cell]
    c, s = bisect_directions(cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1])
    low, high, near, far = zbuffer.edge[cell], zbuffer.edge[cell + 1], zbuffer.near[cell], zbuffer.far[cell]
    return Facet(low, high, c, s, near, distance, far, zbuffer.incidence[cell], rays_apart(source, distance))


@inlined_uncounted
def is_cell_clear(zbuffer, cell, bed, knot):
    """Whether the bed hides nothing in a cell of a z-buffer: its horizon lies below the start of the cell."""
    cosine = zbuffer.cosine
    farthest = max(zbuffer.near[cell] * cosine[cell], zbuffer.far[cell] * cosine[cell + 1])
    return horizon_at(bed, knot_before(bed, farthest, knot), farthest) * cosine[cell] <= zbuffer.sine[cell]


@inlined_uncounted
def visible_facet(primitive, low, high, k, facets, bed, knot):
    """Part of facet k of a cell that the bed does not hide."""
    step = (high - low) / facets
    start, stop = low + k * step, low + (k + 1) * step
    facet = intersect_facet(primitive, start, stop)
    risen = _is_clear(facet.near, start, bed, knot)
    if risen == _is_clear(facet.far, stop, bed, knot):
        return facet if risen else intersect_facet(primitive, stop, stop)
    clear, hidden = (start, stop) if risen else (stop, start)
    for _ in range(HALVINGS):
        middle = 0.5 * (clear + hidden)
        distance = intersect_primitive(primitive, math.cos(middle), math.sin(middle))[0]
        if _is_clear(distance, middle, bed, knot):
            clear = middle
        else:
            hidden = middle
    return intersect_facet(primitive, start, clear) if risen else intersect_facet(primitive, clear, stop)


@inlined_uncounted
def _is_clear(distance, angle, bed, knot):
    """Whether the bed leaves a place above it visible to the sonar, at a distance and a launch angle."""
    c, s = math.cos(angle), math.sin(angle)
    level = distance * c
    return horizon_at(bed, knot_before(bed, level, knot), level) * c <= s


@inlined_uncounted
def _facet_count(facet):
    """Count the facets of a cell: each is short against its range, so that one density holds for it."""
    nearest = min(facet.near, facet.far)
    # Law of cosines: two sides and the angle between them give the third.
    along = facet.far - facet.near
    squared = along * along + facet.near * facet.far * (facet.high - facet.low) ** 2
    if not FINE * FINE * nearest * nearest < squared < NEVER:
        return 1
    return int(min(math.sqrt(squared) / (FINE * nearest) + 1.0, MOST_FACETS))


@inlined_uncounted
def intersect_facet(primitive, low, high):
    """Intersect a primitive along the beginning, the middle and the end of a facet."""
    near, _ = intersect_primitive(primitive, math.cos(low), math.sin(low))
    c, s = math.cos(0.5 * (low + high)), math.sin(0.5 * (low + high))
    centre, incidence = intersect_primitive(primitive, c, s)
    far, _ = intersect_primitive(primitive, math.cos(high), math.sin(high))
    return Facet(low, high, c, s, near, centre, far, incidence, rays_apart(primitive.source, centre))


@inlined_uncounted
def target_of_body(solids, mesh, body):
    """Index of the declared target that a body belongs to."""
    bodies = solids.shape.size
    return solids.target[body] if body < bodies else mesh.target[body - bodies]


@inlined_uncounted
def primitive_material(solids, mesh, zbuffer, p):
    """Row of the reflectivity table that a primitive is made of."""
    body, bodies = zbuffer.body[p], solids.shape.size
    return solids.material[body] if body < bodies else mesh.material[body - bodies]


@inlined_uncounted
def knot_before(bed, x, i):
    """Last knot at or before a ground range."""
    while i + 1 < bed.knots and bed.x[i + 1] <= x:
        i += 1
    while i >= 0 and bed.x[i] > x:
        i -= 1
    return i


@inlined_uncounted
def horizon_at(bed, i, x):
    """Greatest launch slope of the bed up to a ground range."""
    if i < 0:
        return -NEVER
    ridge = bed.slope[i]
    if i + 1 < bed.knots and x > 0.0:
        share = (x - bed.x[i]) / (bed.x[i + 1] - bed.x[i])
        slope = (bed.z[i] + share * (bed.z[i + 1] - bed.z[i])) / x
        if slope > ridge:
            ridge = slope
    return ridge
