"""What targets send back, and what they leave open of the bed behind them."""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.kernels.beam.azimuth_sector import sector_weight
from insonify.kernels.common.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.common.range_bins import FIXED_POINT, spread_energy
from insonify.kernels.common.scattering import backscatter_strength
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.cross_sections import NEVER
from insonify.kernels.sweep.partial_segments import FINE, deposit_partial_segment
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, bisect_directions
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.occlusion import next_visible
from insonify.kernels.targets.primitives import intersect_primitive, load_primitive

MOST_FACETS = 64.0
HALVINGS = 10  # that find where a facet comes out of the bed


@kernel_uncounted
def deposit_visible_stretches(segment, x_from, x_to, occlusion, law, bin_length, bins):
    """Deposit what no body hides of a segment of the bed, between two ground ranges."""
    low, high = launch_angle(segment, x_from), launch_angle(segment, x_to)
    while low < high:
        opened, closed = next_visible(occlusion, segment, low, high)
        if opened >= high:
            return
        start = x_from if opened <= low else ground_range_at(segment, opened)
        stop = x_to if closed >= high else ground_range_at(segment, closed)
        deposit_partial_segment(segment, max(start, x_from), min(stop, x_to), law, bin_length, bins)
        low, x_from = closed, stop


@inlined_uncounted
def launch_angle(segment, x):
    """Launch angle to a segment at ground range x."""
    return math.atan2(segment.offset + segment.slope * x, x)


@inlined_uncounted
def ground_range_at(segment, angle):
    """Ground range at which a launch angle meets a segment's line."""
    return segment.offset / (math.tan(angle) - segment.slope)


class Facet(NamedTuple):
    """A small part of a body, wholly heard."""

    low: float  # launch angle at which it begins, rad
    high: float  # and ends
    cosine: float  # of the launch angle of its middle
    sine: float
    near: float  # distances along its beginning, its middle and its end
    centre: float
    far: float
    incidence: float  # cosine of the incidence in the middle


@kernel_uncounted
def deposit_targets(profile, knots, horizon, arrays, sector, plane, zbuffer, cells, bins):
    """Deposit what the nearest body in every cell sends back, less what the bed hides."""
    # Taking an array out of the problem costs more than a facet: out of the loop with them.
    solids, mesh, table, pattern = arrays.solids, arrays.mesh, arrays.reflectivity, arrays.pattern
    law, bin_length, nearest = arrays.law, arrays.bin_length, zbuffer.nearest
    edge, cosine, sine = zbuffer.edge, zbuffer.cosine, zbuffer.sine
    near, distance, far, incidence = zbuffer.near, zbuffer.distance, zbuffer.far, zbuffer.incidence
    x, z, sources, knot = profile.x, profile.z, zbuffer.source, -1
    for cell in range(cells):
        if nearest[cell] == NO_PRIMITIVE:
            continue
        row = primitive_material(solids, mesh, zbuffer, nearest[cell])
        source = load_apparent_source(sector.bent, sources[nearest[cell]])
        gain = source.gain
        c, s = bisect_directions(cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1])
        facet = Facet(edge[cell], edge[cell + 1], c, s, near[cell], distance[cell], far[cell], incidence[cell])
        facets = facet_count(facet)
        # Neighbouring cells mostly meet neighbouring places.
        farthest = max(facet.near * cosine[cell], facet.far * cosine[cell + 1])
        knot = knot_before(x, knots, farthest, knot)
        ridge = horizon_at(x, z, knots, horizon, knot, farthest)
        if facets == 1 and ridge * cosine[cell] <= sine[cell]:
            _deposit_facet(
                facet, gain, table[row, 0], table[row, 1], table[row, 2], sector, pattern, law, bin_length, bins
            )
            continue
        primitive = load_primitive(
            solids, mesh, plane, zbuffer.body[nearest[cell]], zbuffer.line[nearest[cell]], source
        )
        for k in range(facets):
            facet = visible_facet(primitive, edge[cell], edge[cell + 1], k, facets, x, z, knots, horizon, knot)
            _deposit_facet(
                facet, gain, table[row, 0], table[row, 1], table[row, 2], sector, pattern, law, bin_length, bins
            )


@inlined_uncounted
def visible_facet(primitive, low, high, k, facets, x, z, knots, horizon, knot):
    """Facet k of so many in a cell, less what the bed hides of it; empty if it hides all."""
    step = (high - low) / facets
    start, stop = low + k * step, low + (k + 1) * step
    facet = intersect_facet(primitive, start, stop)
    risen = _is_clear(facet.near, start, x, z, knots, horizon, knot)
    if risen == _is_clear(facet.far, stop, x, z, knots, horizon, knot):
        return facet if risen else intersect_facet(primitive, stop, stop)
    clear, hidden = (start, stop) if risen else (stop, start)
    for _ in range(HALVINGS):
        middle = 0.5 * (clear + hidden)
        distance = intersect_primitive(primitive, math.cos(middle), math.sin(middle))[0]
        if _is_clear(distance, middle, x, z, knots, horizon, knot):
            clear = middle
        else:
            hidden = middle
    return intersect_facet(primitive, start, clear) if risen else intersect_facet(primitive, clear, stop)


@inlined_uncounted
def _is_clear(distance, angle, x, z, knots, horizon, knot):
    """Whether a place above the bed is in sight of the sonar, at a distance and a launch angle."""
    c, s = math.cos(angle), math.sin(angle)
    level = distance * c
    return horizon_at(x, z, knots, horizon, knot_before(x, knots, level, knot), level) * c <= s


@inlined_uncounted
def facet_count(facet):
    """How many facets a cell is divided into: one that is long against its range has not one density."""
    nearest = min(facet.near, facet.far)
    # Two sides and the angle between them give the third.
    along = facet.far - facet.near
    squared = along * along + facet.near * facet.far * (facet.high - facet.low) ** 2
    if not FINE * FINE * nearest * nearest < squared < NEVER:
        return 1
    return int(min(math.sqrt(squared) / (FINE * nearest) + 1.0, MOST_FACETS))


@inlined_uncounted
def intersect_facet(primitive, low, high):
    """Meet a part along the beginning, the middle and the end of a facet."""
    near, _ = intersect_primitive(primitive, math.cos(low), math.sin(low))
    c, s = math.cos(0.5 * (low + high)), math.sin(0.5 * (low + high))
    centre, incidence = intersect_primitive(primitive, c, s)
    far, _ = intersect_primitive(primitive, math.cos(high), math.sin(high))
    return Facet(low, high, c, s, near, centre, far, incidence)


@inlined_uncounted
def is_facet_met(facet):
    """Whether there is anything of a facet, all of it met."""
    return facet.low < facet.high and max(facet.near, facet.far, facet.centre) < NEVER


@inlined_uncounted
def _deposit_facet(facet, gain, diffuse, specular, shininess, sector, pattern, law, bin_length, bins):
    """Deposit one facet; its ends give the slant ranges, its middle the strength."""
    if not is_facet_met(facet):
        return
    first, second = facet_energies(facet, gain, diffuse, specular, shininess, sector, pattern, law, bin_length)
    last, per_bin = bins.size - 2, 1.0 / bin_length
    spread_energy(bins, facet.near * per_bin, facet.centre * per_bin, first, last)
    spread_energy(bins, facet.centre * per_bin, facet.far * per_bin, second, last)


@inlined_uncounted
def primitive_material(solids, mesh, zbuffer, p):
    """Row of the reflectivity table that a part is made of."""
    body, bodies = zbuffer.body[p], solids.shape.size
    return solids.material[body] if body < bodies else mesh.material[body - bodies]


@inlined_uncounted
def facet_energies(facet, gain, diffuse, specular, shininess, sector, pattern, law, bin_length):
    """Energies of a facet, in fixed-point units, on either hand of its middle."""
    value = backscatter_strength(facet.incidence, diffuse, specular, shininess, law)
    x, z = facet.centre * facet.cosine, facet.centre * facet.sine
    value *= gain * sector_weight(x, z, facet.centre, sector, pattern, law)
    if law == LIGHT:
        density = value / bin_length * FIXED_POINT
        return density * abs(facet.centre - facet.near), density * abs(facet.far - facet.centre)
    # The strip seen along the ray: width · r dθ, laid out on the surface: / cos of the incidence.
    half = 0.5 * value * facet.centre * (facet.high - facet.low) / max(facet.incidence, 1e-6) * FIXED_POINT
    return half, half


@inlined_uncounted
def knot_before(ground_range, knots, x, i):
    """Last knot at or before ground range x, looked for from knot i on; -1 if there is none."""
    while i + 1 < knots and ground_range[i + 1] <= x:
        i += 1
    while i >= 0 and ground_range[i] > x:
        i -= 1
    return i


@inlined_uncounted
def horizon_at(ground_range, height, knots, horizon, i, x):
    """Greatest slope of the bed up to ground range x, which lies beyond knot i and not beyond the next."""
    if i < 0:
        return -NEVER
    ridge = horizon[i]
    if i + 1 < knots and x > 0.0:
        share = (x - ground_range[i]) / (ground_range[i + 1] - ground_range[i])
        slope = (height[i] + share * (height[i + 1] - height[i])) / x
        if slope > ridge:
            ridge = slope
    return ridge
