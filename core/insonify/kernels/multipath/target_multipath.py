"""Echoes of targets out by one image of the sonar and back by another.

Theory: docs/theory/multipath.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from insonify.kernels.beam.azimuth_sector import is_whole_beam, paired_weight, sector_weight
from insonify.kernels.common.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.common.search import last_not_above
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.cross_sections import NEVER, HalfPlane
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
    divide_facet,
    facet_curve,
    is_facet_met,
    tilt_in_plane,
)
from insonify.kernels.sweep.target_echoes import (
    BedHorizon,
    cell_facet,
    count_facets,
    horizon_at,
    intersect_facet,
    is_cell_clear,
    knot_before,
    primitive_material,
    visible_facet,
)
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, AngularZbuffer
from insonify.kernels.targets.apparent_targets import load_apparent_source
from insonify.kernels.targets.primitives import TRIANGLE, Primitive, intersect_primitive, load_primitive

HALVINGS = 12  # that find where the higher image stops to see a facet
HALVES = 2  # parts of a facet at least, to follow the lobe between two ways
LIT_PARTS = 2  # times as many under law `light`, whose means of both ends err twice as much as middles do
INSIDE = 1e-9  # share of a facet by which radiance is taken inside its ends
ROUNDING = 1e-7  # share of a distance that is no distance
BEFORE = 1e-4  # share of a distance by which a primitive must come nearer to hide a place


class TargetSurface(NamedTuple):
    """Surface of a target that a cell of a z-buffer meets."""

    primitive: Primitive
    numbers: tuple[float, float, float]  # Lambert's share, Phong's share and its exponent
    contributor: int


class TiltAlong(NamedTuple):
    """Tilt of a facet within the plane, and what is left of it across the plane, as both images see its middle."""

    scale: float  # the tilt is scale times that of the facet's parabola, plus shift
    shift: float
    left: float  # tan² of the incidence is the tilt's square plus this


class HigherView(NamedTuple):
    """What the higher of two images sees of a plane."""

    raised: float  # height above the lower image, m
    before: float  # share of a distance by which a body's near side must come before a place of it to hide it
    bed: BedHorizon
    zbuffer: AngularZbuffer
    cells: int


@kernel_uncounted
def list_target_echoes(arrays, knots, pair, plane, sectors, cells, x, views, zbuffers, echoes, n, sink):
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
    x : ndarray of float64
        Ground ranges of the knots, m.
    views : tuple of two ImageProfile
        The bed as the lower and the higher image see it.
    zbuffers : tuple of two AngularZbuffer
        Of the lower and the higher image.
    echoes : ndarray of float64, shape (ROOM, COLUMNS)
    n : int
        Echoes that are listed already.
    sink : EchoSink

    Returns
    -------
    int
        Echoes in the list that are not deposited yet.
    """
    solids, mesh, table, zbuffer = arrays.solids, arrays.mesh, arrays.reflectivity, zbuffers[0]
    bodies, knot, (one, other) = arrays.solids.shape.size, -1, views
    bed, bed_of_higher = BedHorizon(x, one.z, one.horizon, knots), BedHorizon(x, other.z, other.horizon, knots)
    # Law `light` cuts facets where a body turns away from the higher image: that place must be sharp.
    before, raised = (ROUNDING if pair.law == LIGHT else BEFORE), pair.other.height - pair.one.height
    higher = HigherView(raised, before, bed_of_higher, zbuffers[1], cells[1])
    seen_from = HalfPlane(plane.x, plane.y, plane.z + pair.one.height, plane.ex, plane.ey)
    for cell in range(cells[0]):
        p = zbuffer.nearest[cell]
        if p == NO_PRIMITIVE:
            continue
        body, row = zbuffer.body[p], primitive_material(solids, mesh, zbuffer, p)
        contributor = table.shape[0] + (solids.target[body] if body < bodies else mesh.target[body - bodies])
        facets, centre = count_facets(zbuffer, cell)
        knot = knot_before(bed, centre, knot)
        source = load_apparent_source(False, zbuffer.source[p])
        primitive = load_primitive(solids, mesh, seen_from, body, zbuffer.line[p], source)
        surface = TargetSurface(primitive, (table[row, 0], table[row, 1], table[row, 2]), contributor)
        low, high = zbuffer.edge[cell], zbuffer.edge[cell + 1]
        whole = facets == 1 and is_cell_clear(zbuffer, cell, bed, knot)
        for k in range(facets):
            # A cell that is whole has been met along its beginning, its middle and its end.
            facet = cell_facet(zbuffer, cell) if whole else visible_facet(primitive, low, high, k, facets, bed, knot)
            if not is_facet_met(facet):
                continue
            cos_other = facet.incidence
            if higher.raised > 0.0:
                if pair.law == LIGHT:
                    facet = _cut_facet(facet, primitive, body, higher, knot)
                cos_other = _incidence_at_higher(facet.centre, facet.cosine, facet.sine, primitive, body, higher, knot)
            if cos_other > 0.0:
                n = _list_facet(arrays.pattern, pair, facet, cos_other, surface, sectors, echoes, n)
        if n > ENOUGH:
            deposit_echoes(echoes, n, arrays.multipath.facets[pair.passes - 1], arrays.bin_length, pair.path, sink)
            n = 0
    return n


@inlined_uncounted
def _cut_facet(facet, primitive, body, higher, knot):
    """Part of a facet that the higher image sees, as law `light` needs it.

    Light counts the slant range that a facet spans, most of which may lie where it turns away from the higher image;
    law `sonar` counts its area, seen there at a vanishing cosine.
    """
    clear, hidden = facet.low, facet.high
    begins = _incidence_along(clear, primitive, body, higher, knot) > 0.0
    if begins == (_incidence_along(hidden, primitive, body, higher, knot) > 0.0):
        return facet
    if not begins:
        clear, hidden = hidden, clear
    for _ in range(HALVINGS):
        middle = 0.5 * (clear + hidden)
        if _incidence_along(middle, primitive, body, higher, knot) > 0.0:
            clear = middle
        else:
            hidden = middle
    return intersect_facet(primitive, facet.low, clear) if begins else intersect_facet(primitive, clear, facet.high)


@inlined_uncounted
def _incidence_along(angle, primitive, body, higher, knot):
    """Cosine of the incidence from the higher image where a launch angle of the lower one meets a primitive."""
    c, s = math.cos(angle), math.sin(angle)
    distance, _ = intersect_primitive(primitive, c, s)
    if not distance < NEVER:
        return 0.0
    return _incidence_at_higher(distance, c, s, primitive, body, higher, knot)


@inlined_uncounted
def _incidence_at_higher(distance, c, s, primitive, body, higher, knot):
    """Cosine of the incidence from the higher image, of a place given from the lower one; 0 if it is not seen."""
    r, incidence = _meet_from_higher(distance, c, s, primitive, higher.raised, higher.before)
    if incidence == 0.0:
        return 0.0
    level, height = distance * c, distance * s - higher.raised
    c, s = level / r, height / r
    if horizon_at(higher.bed, knot_before(higher.bed, level, knot), level) * c > s:
        return 0.0
    zbuffer, cells = higher.zbuffer, higher.cells
    cell = last_not_above(zbuffer.edge[: cells + 1], math.atan2(height, level))
    if 0 <= cell < cells and zbuffer.nearest[cell] != NO_PRIMITIVE and zbuffer.body[zbuffer.nearest[cell]] != body:
        if (zbuffer.nearness_cosine[cell] * c + zbuffer.nearness_sine[cell] * s) * r > 1.0 + BEFORE:
            return 0.0
    return incidence


@inlined_uncounted
def _meet_from_higher(distance, c, s, primitive, raised, before):
    """Distance from the higher image to a place given from the lower one, and the cosine of the incidence there.

    The cosine is 0 on the far side of a body, whose near side comes before by more than a share of the distance.
    """
    level, height = distance * c, distance * s - raised
    r = math.sqrt(level * level + height * height)
    higher_c, higher_s = level / r, height / r
    if primitive.kind == TRIANGLE:
        # Both must be on the same side of a triangle.
        front = c * primitive.level_x + s * primitive.level_y
        if front * (higher_c * primitive.level_x + higher_s * primitive.level_y) <= 0.0:
            return r, 0.0
    lower = Primitive(
        primitive.kind, primitive.x, primitive.y, primitive.z - raised, primitive.ax, primitive.ay, primitive.az,
        primitive.length, primitive.radius, primitive.taper, primitive.level_x, primitive.level_y, primitive.source,
    )  # fmt: skip
    met, incidence = intersect_primitive(lower, higher_c, higher_s)
    return r, incidence if met > r * (1.0 - before) else 0.0


@inlined_uncounted
def _list_facet(pattern, pair, facet, cos_other, surface, sectors, echoes, n):
    """List a facet that both images see, part by part."""
    raised, per_bin, numbers = pair.other.height - pair.one.height, 1.0 / pair.bin_length, surface.numbers
    whole = _echo_of_facet(pattern, pair, facet, cos_other, surface.contributor, sectors)
    x, a = facet.centre * facet.cosine, facet.centre * facet.sine
    r_other = _distance(facet.centre, facet.cosine, facet.sine, raised)
    mirrored = 2.0 * facet.incidence * cos_other - (x * x + a * (a - raised)) / (facet.centre * r_other)
    middle, off_mirror = 0.5 * (facet.centre + r_other), max(0.5 - 0.5 * mirrored, 0.0)
    parts, _ = divide_facet(facet, off_mirror, numbers, whole.near * per_bin, middle * per_bin, whole.far * per_bin)
    parts = max(parts, HALVES)
    if pair.law == LIGHT:
        return _list_light(pair, facet, whole, LIT_PARTS * parts, surface, echoes, n)
    curve, near = facet_curve(facet), whole.near
    tilt = _tilt_along(facet, curve, cos_other, raised)
    for k in range(parts):
        far, energy = _part_of_pair(facet, curve, tilt, k, parts, numbers, pair, raised)
        n, near = list_echo(echoes, n, _part_of_echo(whole, near, far, energy)), far
    return n


@inlined_uncounted
def _echo_of_facet(pattern, pair, facet, cos_other, contributor, sectors):
    """Slant ranges and delays of the echo of a facet, with the weight of its plane and spreading as its energy."""
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
    near, far = _pair_range(facet.near, facet.low, raised), _pair_range(facet.far, facet.high, raised)
    return SurfaceEcho(near, far, weight, rise, tilt, x, min(facet.incidence, cos_other), contributor)


@inlined_uncounted
def _part_of_echo(whole, near, far, energy):
    """Echo of a part of a facet, of an energy before weight and spreading."""
    return SurfaceEcho(
        near, far, whole.energy * energy, whole.rise, whole.tilt, whole.x, whole.cosine, whole.contributor
    )


@inlined_uncounted
def _list_light(pair, facet, whole, parts, surface, echoes, n):
    """List a facet under law `light`: every part has the mean radiance of its ends over the slant range it spans.

    Towards a body's edge slant range changes as the root of the launch angle that is left, where a parabola errs, but
    the cosines are linear in slant range.
    """
    raised = pair.other.height - pair.one.height
    near, before = _radiance_along(surface, facet, 0.0, pair, raised)
    for k in range(parts):
        far, after = _radiance_along(surface, facet, (k + 1.0) / parts, pair, raised)
        energy = 0.5 * (before + after) * abs(far - near) / pair.bin_length
        n = list_echo(echoes, n, _part_of_echo(whole, near, far, energy))
        near, before = far, after
    return n


@inlined_uncounted
def _radiance_along(surface, facet, share, pair, raised):
    """Slant range and radiance for a pair of images at a share of the launch angle of a facet, intersected there."""
    # At the very ends a body may be missed, or one face be taken for another.
    angle = facet.low + min(max(share, INSIDE), 1.0 - INSIDE) * (facet.high - facet.low)
    c, s = math.cos(angle), math.sin(angle)
    distance, cosine = intersect_primitive(surface.primitive, c, s)
    r_other, cos_other = _meet_from_higher(distance, c, s, surface.primitive, raised, ROUNDING)
    mirrored = 2.0 * cosine * cos_other - (distance - raised * s) / r_other
    diffuse, specular, shininess = surface.numbers
    value = pair_strength(cosine, cos_other, mirrored, diffuse, specular, shininess, pair)
    return 0.5 * (distance + r_other), value


@inlined_uncounted
def _tilt_along(facet, curve, cos_other, raised):
    """Tilt along a facet, such that both images see its middle at the incidences that they meet it at.

    The parabola's slope differs from the surface's by the third derivative of slant range, which a narrow lobe between
    two directions would notice.
    """
    scale, left = math.sqrt(curve.gain), curve.left
    if raised <= 0.0:
        return TiltAlong(scale, 0.0, left)
    r, c, s, cosine = facet.centre, facet.cosine, facet.sine, facet.incidence
    r_other = _distance(r, c, s, raised)
    # The cosine at the higher image is cosine · (along - tilt · across), as in `_part_of_pair`.
    tilt = ((r - raised * s) / r_other - cos_other / cosine) * r_other / (-raised * c)
    shift = tilt - scale * tilt_in_plane(curve, along_curve(facet, curve, 0.5), 0.5)
    return TiltAlong(scale, shift, max(1.0 / (cosine * cosine) - 1.0 - tilt * tilt, 0.0))


@inlined_uncounted
def _part_of_pair(facet, curve, tilt_along, k, parts, numbers, pair, raised):
    """Slant range at which part k of a facet ends and its energy, out by one image and back by the other."""
    angle = facet.low + (k + 0.5) / parts * curve.angle
    r, c, s = along_curve(facet, curve, (k + 0.5) / parts), math.cos(angle), math.sin(angle)
    far = _pair_range(along_curve(facet, curve, (k + 1.0) / parts), facet.low + (k + 1.0) / parts * curve.angle, raised)
    tilt = tilt_along.scale * tilt_in_plane(curve, r, (k + 0.5) / parts) + tilt_along.shift
    cosine, r_other = 1.0 / math.sqrt(1.0 + tilt * tilt + tilt_along.left), _distance(r, c, s, raised)
    # Parts of the higher image's direction along the lower one's and across it; the normal is -(1, -tilt) in the plane.
    along, across = (r - raised * s) / r_other, -raised * c / r_other
    cos_other = cosine * (along - tilt * across)
    mirrored = 2.0 * cosine * cos_other - along
    value = pair_strength(cosine, cos_other, mirrored, numbers[0], numbers[1], numbers[2], pair)
    # Area dA = width · r dθ / cos α, seen at incidence α: docs/theory/sweep.md
    return far, value * r * curve.angle / (parts * cosine)


@inlined_uncounted
def _pair_range(distance, angle, raised):
    """Slant range of an echo out by the lower image, in a direction and at a distance, and back by the higher one."""
    return 0.5 * (distance + _distance(distance, math.cos(angle), math.sin(angle), raised))


@inlined_uncounted
def _distance(distance, c, s, raised):
    """Distance from the higher image to a point in the direction (c, s) from the lower one."""
    height = distance * s - raised
    return math.sqrt(distance * distance * c * c + height * height)
