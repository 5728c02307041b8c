"""Echoes of targets out by one image of the sonar and back by another.

Theory: docs/theory/multipath.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.beam.azimuth_sector import is_whole_beam, paired_weight, sector_weight
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.multipath.echo_list import ENOUGH, SurfaceEcho, deposit_echoes, list_echo
from insonify.kernels.multipath.image_sources import (
    height_delay,
    pair_response,
    pair_strength,
    spreading_ratio,
    tilt_delay,
)
from insonify.kernels.sweep.facets import (
    along_curve,
    cos_incidence,
    divide_facet,
    facet_curve,
    is_facet_met,
    tilt_in_plane,
)
from insonify.kernels.sweep.target_echoes import (
    BedHorizon,
    count_facets,
    horizon_at,
    knot_before,
    primitive_material,
    visible_facet,
)
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.primitives import TRIANGLE, Primitive, intersect_primitive, load_primitive

HALVES = 2  # parts of a facet at least, to follow the lobe between two ways
BEFORE = 1e-4  # share of a distance by which another primitive must come nearer to hide a place


@kernel
def list_target_echoes(arrays, knots, pair, plane, sectors, cells, workspace, n, sink):
    """List the echoes of targets that both images see, facet by facet, depositing them where the list gets full.

    Parameters
    ----------
    arrays : SceneArrays
    knots : int
        Of the profile.
    pair : ImagePath
    plane : HalfPlane
        From the sonar itself.
    sectors : tuple of two AzimuthSector
        What the plane stands for, as the lower and the higher image have it.
    cells : tuple of two int
        Cells of both images' z-buffers.
    workspace : MultipathWorkspace
        Filled for this plane.
    n : int
        Echoes that are listed already.
    sink : EchoSink

    Returns
    -------
    int
        Echoes in the list that are not deposited yet.
    """
    solids, mesh, table, zbuffer = arrays.solids, arrays.mesh, arrays.reflectivity, workspace.zbuffers[0]
    x, echoes, bodies, knot = workspace.profile.x, workspace.echoes, arrays.solids.shape.size, -1
    bed = BedHorizon(x, workspace.images[0].z, workspace.images[0].horizon, knots)
    bed_of_other = BedHorizon(x, workspace.images[1].z, workspace.images[1].horizon, knots)
    raised = pair.other.height - pair.one.height
    seen_from = HalfPlane(plane.x, plane.y, plane.z + pair.one.height, plane.ex, plane.ey)
    for cell in range(cells[0]):
        p = zbuffer.nearest[cell]
        if p == NO_PRIMITIVE:
            continue
        body, row = zbuffer.body[p], primitive_material(solids, mesh, zbuffer, p)
        contributor = table.shape[0] + (solids.target[body] if body < bodies else mesh.target[body - bodies])
        numbers = table[row, 0], table[row, 1], table[row, 2]
        facets, centre = count_facets(zbuffer, cell)
        knot = knot_before(bed, centre, knot)
        source = load_apparent_source(False, zbuffer.source[p])
        primitive = load_primitive(solids, mesh, seen_from, body, zbuffer.line[p], source)
        low, high = zbuffer.edge[cell], zbuffer.edge[cell + 1]
        for k in range(facets):
            facet = visible_facet(primitive, low, high, k, facets, bed, knot)
            if not is_facet_met(facet):
                continue
            cos_other = facet.incidence
            if raised > 0.0:
                level = facet.centre * facet.cosine
                ridge = horizon_at(bed_of_other, knot_before(bed_of_other, level, knot), level)
                cos_other = _incidence_at_higher(facet, primitive, body, raised, ridge, workspace.zbuffers[1], cells[1])
            if cos_other > 0.0:
                n = _list_facet(arrays.pattern, pair, facet, cos_other, numbers, sectors, contributor, echoes, n)
        if n > ENOUGH:
            deposit_echoes(echoes, n, arrays.multipath.facets[pair.passes - 1], arrays.bin_length, pair.path, sink)
            n = 0
    return n


@inlined
def _incidence_at_higher(facet, primitive, body, raised, ridge, zbuffer, cells):
    """Cosine of the incidence at the middle of a facet as the higher image sees it; 0 if it does not."""
    level, height = facet.centre * facet.cosine, facet.centre * facet.sine - raised
    r = math.sqrt(level * level + height * height)
    c, s = level / r, height / r
    if primitive.kind == TRIANGLE:
        # Both must be on the same side of a triangle.
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
    cell = np.searchsorted(zbuffer.edge[: cells + 1], math.atan2(height, level), side="right") - 1
    if 0 <= cell < cells and zbuffer.nearest[cell] != NO_PRIMITIVE and zbuffer.body[zbuffer.nearest[cell]] != body:
        if (zbuffer.nearness_cosine[cell] * c + zbuffer.nearness_sine[cell] * s) * r > 1.0 + BEFORE:
            return 0.0
    return incidence


@inlined
def _list_facet(pattern, pair, facet, cos_other, numbers, sectors, contributor, echoes, n):
    """List a facet that both images see, part by part; its middle gives weight, spreading and delays."""
    law, raised = pair.law, pair.other.height - pair.one.height
    x, a = facet.centre * facet.cosine, facet.centre * facet.sine
    r_other, b = _distance(facet.centre, facet.cosine, facet.sine, raised), a - raised
    rise_one, rise_other = -a if pair.one.mirrored else a, -b if pair.other.mirrored else b
    if is_whole_beam(sectors[0]) and pattern.two_way:
        weight = paired_weight(x, (rise_one, facet.centre), (rise_other, r_other), sectors[0], pattern, law)
    else:
        one = sector_weight(x, rise_one, facet.centre, sectors[0], pattern, law)
        other = sector_weight(x, rise_other, r_other, sectors[1], pattern, law)
        weight = pair_response(one, other, pattern.tabulated, pattern.two_way)
    weight *= spreading_ratio(facet.centre, r_other, law)
    rms, variance = pair.rms_height, pair.slope_variance
    rise = height_delay(pair.one, -a, facet.centre, rms) + height_delay(pair.other, -b, r_other, rms)
    tilt = tilt_delay(pair.one, -a, facet.centre, variance) + tilt_delay(pair.other, -b, r_other, variance)
    mirrored = 2.0 * facet.incidence * cos_other - (x * x + a * b) / (facet.centre * r_other)
    curve, near = facet_curve(facet), _pair_range(facet.near, facet.low, raised)
    far, per_bin = _pair_range(facet.far, facet.high, raised), 1.0 / pair.bin_length
    middle, off_mirror = 0.5 * (facet.centre + r_other), max(0.5 - 0.5 * mirrored, 0.0)
    parts, _ = divide_facet(facet, off_mirror, numbers, near * per_bin, middle * per_bin, far * per_bin)
    parts = max(parts, HALVES)
    for k in range(parts):
        far, energy = _part_of_pair(facet, curve, k, parts, near, numbers, pair, raised)
        echo = SurfaceEcho(near, far, weight * energy, rise, tilt, x, min(facet.incidence, cos_other), contributor)
        n, near = list_echo(echoes, n, echo), far
    return n


@inlined
def _part_of_pair(facet, curve, k, parts, near, numbers, pair, raised):
    """Slant range at which part k of a facet ends and its energy, out by one image and back by the other."""
    angle = facet.low + (k + 0.5) / parts * curve.angle
    r, c, s = along_curve(facet, curve, (k + 0.5) / parts), math.cos(angle), math.sin(angle)
    far = _pair_range(along_curve(facet, curve, (k + 1.0) / parts), facet.low + (k + 1.0) / parts * curve.angle, raised)
    tilt = tilt_in_plane(curve, r, (k + 0.5) / parts)
    cosine, r_other = cos_incidence(curve, tilt), _distance(r, c, s, raised)
    # Parts of the higher image's direction along the lower one's and across it; the normal is -(1, -tilt) in the plane.
    along, across = (r - raised * s) / r_other, -raised * c / r_other
    cos_other = cosine * (along - tilt * across)
    mirrored = 2.0 * cosine * cos_other - along
    value = pair_strength(cosine, cos_other, mirrored, numbers[0], numbers[1], numbers[2], pair)
    if pair.law == LIGHT:
        return far, value * abs(far - near) / pair.bin_length
    # Area dA = width · r dθ / cos α, seen at incidence α: docs/theory/sweep.md
    return far, value * r * curve.angle / (parts * cosine)


@inlined
def _pair_range(distance, angle, raised):
    """Slant range of an echo out by the lower image, in a direction and at a distance, and back by the higher one."""
    return 0.5 * (distance + _distance(distance, math.cos(angle), math.sin(angle), raised))


@inlined
def _distance(distance, c, s, raised):
    """Distance from the higher image to a point in the direction (c, s) from the lower one."""
    height = distance * s - raised
    return math.sqrt(distance * distance * c * c + height * height)
