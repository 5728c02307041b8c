"""Nearest primitive in every cell of a z-buffer, and the distances to it.

Bodies have many cells and are met by all rays at once; triangles have few and are met ray by ray.

Theory: docs/theory/sweep.md.
"""

from __future__ import annotations

import math

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.common.search import last_not_above
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.body_rays import meet_body
from insonify.kernels.targets.directions import bisect_directions
from insonify.kernels.targets.primitives import intersect_primitive, load_primitive, meet_primitive


@inlined_uncounted
def find_nearest(solids, mesh, plane, bent, zbuffer, solid_primitives, primitives, cells):
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
    """Enter a body in the cells where it is nearer than what they hold: its distances along middles and edges.

    Rays that it need not meet are followed too, because all of them at once take less time than one by one.
    """
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
    """Keep other values of cells in which something is nearer than what they hold."""
    for k in range(count):
        kept[k] = values[k] if here[k] < distance[k] else kept[k]


@inlined_uncounted
def _replace_of(p, count, nearest, values, kept):
    """Keep other values of cells in which a primitive is the nearest."""
    for k in range(count):
        kept[k] = values[k] if nearest[k] == p else kept[k]


@inlined_uncounted
def _keep_nearer_triangle(p, triangle, cells, zbuffer):
    """Enter a triangle in the cells where it is nearer than what they hold; of two at one distance the first stays."""
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
