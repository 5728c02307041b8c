"""What targets send back out by one image of the sonar and back by another."""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.beam.azimuth_sector import sector_weight
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.multipath.echo_list import ENOUGH, deposit_echoes, list_echo
from insonify.kernels.multipath.image_sources import (
    echo_parameters,
    height_delay,
    pair_response,
    pair_strength,
    spreading_ratio,
    tilt_delay,
)
from insonify.kernels.sweep.target_echoes import (
    Facet,
    facet_count,
    horizon_at,
    is_facet_met,
    knot_before,
    primitive_material,
    visible_facet,
)
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, bisect_directions
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.primitives import TRIANGLE, Primitive, intersect_primitive, load_primitive

BEFORE = 1e-4  # share of a distance by which another part must come nearer to hide a place


@kernel
def list_target_echoes(
    arrays,
    profile,
    knots,
    pair,
    plane,
    sectors,
    image_profiles,
    zbuffers,
    cells,
    cells_other,
    echoes,
    n,
    bins,
    contributions,
    labelling,
):
    """List what is nearest to the lower image in every cell and in sight of the other; return what is not entered."""
    solids, mesh, table, zbuffer = arrays.solids, arrays.mesh, arrays.reflectivity, zbuffers[0]
    x, z, horizon, knot = profile.x, image_profiles[0].z, image_profiles[0].horizon, -1
    sea, pattern, lower, higher = echo_parameters(arrays), arrays.pattern, sectors[0], sectors[1]
    heights, ridges, edge, level, rise = (
        image_profiles[1].z,
        image_profiles[1].horizon,
        zbuffers[1].edge,
        zbuffers[1].nearness_cosine,
        zbuffers[1].nearness_sine,
    )
    nearest, rows = zbuffers[1].nearest, zbuffers[1].body
    bodies, raised = solids.shape.size, pair.other.height - pair.one.height
    seen_from = HalfPlane(plane.x, plane.y, plane.z + pair.one.height, plane.ex, plane.ey)
    for cell in range(cells):
        p = zbuffer.nearest[cell]
        if p == NO_PRIMITIVE:
            continue
        body, row = zbuffer.body[p], primitive_material(solids, mesh, zbuffer, p)
        who = table.shape[0] + (solids.target[body] if body < bodies else mesh.target[body - bodies])
        c, s = bisect_directions(
            zbuffer.cosine[cell], zbuffer.sine[cell], zbuffer.cosine[cell + 1], zbuffer.sine[cell + 1]
        )
        low, high, distance = zbuffer.edge[cell], zbuffer.edge[cell + 1], zbuffer.distance[cell]
        facets = facet_count(Facet(low, high, c, s, zbuffer.near[cell], distance, zbuffer.far[cell], 1.0))
        knot = knot_before(x, knots, distance * c, knot)
        primitive = load_primitive(
            solids, mesh, seen_from, body, zbuffer.line[p], load_apparent_source(False, zbuffer.source[p])
        )
        for k in range(facets):
            facet = visible_facet(primitive, low, high, k, facets, x, z, knots, horizon, knot)
            if not is_facet_met(facet):
                continue
            cos_other = facet.incidence
            if raised > 0.0:
                ridge = _ridge(facet, raised, x, heights, ridges, knots, knot)
                cos_other = _seen(facet, primitive, body, raised, ridge, edge, level, rise, nearest, rows, cells_other)
            if cos_other > 0.0:
                numbers = table[row, 0], table[row, 1], table[row, 2]
                n = _list_facet(sea, pattern, pair, facet, cos_other, numbers, lower, higher, who, echoes, n)
        if n > ENOUGH:
            waves = arrays.multipath.facets[pair.passes - 1]
            deposit_echoes(echoes, n, waves, arrays.bin_length, pair.path, bins, contributions, labelling)
            n = 0
    return n


@inlined
def _ridge(facet, raised, x, z, horizon, knots, knot):
    """Greatest slope of the bed from the higher image up to the middle of a facet."""
    level = facet.centre * facet.cosine
    return horizon_at(x, z, knots, horizon, knot_before(x, knots, level, knot), level)


@inlined
def _seen(facet, primitive, body, raised, ridge, edge, near_level, near_rise, nearest, rows, cells):
    """Cosine of the incidence at the middle of a facet as the higher image sees it; 0 if it does not."""
    level, height = facet.centre * facet.cosine, facet.centre * facet.sine - raised
    r = math.sqrt(level * level + height * height)
    c, s = level / r, height / r
    if primitive.kind == TRIANGLE:
        # Both must be on the same side of a sheet.
        front = facet.cosine * primitive.level_x + facet.sine * primitive.level_y
        if front * (c * primitive.level_x + s * primitive.level_y) <= 0.0:
            return 0.0
    lower = Primitive(
        primitive.kind, primitive.x, primitive.y, primitive.z - raised, primitive.ax, primitive.ay, primitive.az,
        primitive.length, primitive.radius, primitive.taper, primitive.level_x, primitive.level_y, primitive.source,
    )  # fmt: skip
    distance, incidence = intersect_primitive(lower, c, s)
    if not distance > r * (1.0 - BEFORE):
        return 0.0  # the far side of a body
    if ridge * c > s:
        return 0.0
    angle = math.atan2(height, level)
    cell = np.searchsorted(edge[: cells + 1], angle, side="right") - 1
    if 0 <= cell < cells and nearest[cell] != NO_PRIMITIVE and rows[nearest[cell]] != body:
        if (near_level[cell] * c + near_rise[cell] * s) * r > 1.0 + BEFORE:
            return 0.0
    return incidence


@inlined
def _list_facet(sea, pattern, pair, facet, cos_other, numbers, lower, higher, who, echoes, n):
    """List a facet that both images see; its ends give the slant ranges, its middle the strength."""
    law, raised = sea.law, pair.other.height - pair.one.height
    x, a = facet.centre * facet.cosine, facet.centre * facet.sine
    r_other, b = _distance(facet.centre, facet.cosine, facet.sine, raised), a - raised
    mirrored = 2.0 * facet.incidence * cos_other - (x * x + a * b) / (facet.centre * r_other)
    value = pair_strength(facet.incidence, cos_other, mirrored, numbers[0], numbers[1], numbers[2], pair, law)
    one = sector_weight(x, -a if pair.one.mirrored else a, facet.centre, lower, pattern, law)
    other = sector_weight(x, -b if pair.other.mirrored else b, r_other, higher, pattern, law)
    value *= pair_response(one, other, pattern.tabulated, pattern.two_way) * spreading_ratio(facet.centre, r_other, law)
    c_low, s_low, c_high, s_high = math.cos(facet.low), math.sin(facet.low), math.cos(facet.high), math.sin(facet.high)
    near = 0.5 * (facet.near + _distance(facet.near, c_low, s_low, raised))
    middle = 0.5 * (facet.centre + r_other)
    far = 0.5 * (facet.far + _distance(facet.far, c_high, s_high, raised))
    if law == LIGHT:
        first, second = value * abs(middle - near) / sea.bin_length, value * abs(far - middle) / sea.bin_length
    else:
        # The strip seen along the ray: width · r dθ, laid out on the surface: / cos of the incidence.
        first = 0.5 * value * facet.centre * (facet.high - facet.low) / max(facet.incidence, 1e-6)
        second = first
    rms, variance = sea.rms_height, sea.slope_variance
    rise = height_delay(pair.one, -a, facet.centre, rms) + height_delay(pair.other, -b, r_other, rms)
    tilt = tilt_delay(pair.one, -a, facet.centre, variance) + tilt_delay(pair.other, -b, r_other, variance)
    cosine = min(facet.incidence, cos_other)
    n = list_echo(echoes, n, near, middle, first, rise, tilt, x, cosine, who)
    return list_echo(echoes, n, middle, far, second, rise, tilt, x, cosine, who)


@inlined
def _distance(distance, c, s, raised):
    """Distance from the higher image of what lies in the direction (c, s) of the lower one."""
    height = distance * s - raised
    return math.sqrt(distance * distance * c * c + height * height)
