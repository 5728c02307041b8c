"""Echoes of targets out by one image of the sonar and back by another.

Theory: docs/theory/multipath.md.
"""

import math
from typing import NamedTuple

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.beam.azimuth_sector import is_whole_beam, pair_response, paired_weight, sector_weight
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.cross_sections import NEVER, HalfPlane
from insonify.kernels.multipath.echo_list import ENOUGH, SurfaceEcho, deposit_echoes, list_echo
from insonify.kernels.multipath.image_sources import height_delay, pair_strength, spreading_ratio, tilt_delay
from insonify.kernels.sweep.facets import (
    SectorSpan,
    along_curve,
    divide_facet,
    facet_curve,
    is_facet_met,
    span_of_sector,
    tilt_in_plane,
    widen,
)
from insonify.kernels.sweep.target_echoes import (
    BedHorizon,
    cell_facet,
    horizon_at,
    intersect_facet,
    is_cell_clear,
    knot_before,
    load_cell,
    visible_facet,
)
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, AngularZbuffer, cell_towards
from insonify.kernels.targets.primitives import Primitive, meet_primitive

HALVINGS = 12  # that find where the higher image stops to see a facet
# Under law `light` the mean of both ends errs twice as much as the middle: factor of the number of parts, and the
# least number.
LIT_PARTS, LEAST_LIT = 2, 4
INSIDE = 1e-9  # share of a facet by which radiance is taken inside its ends
LEAST_COSINE = 1e-6  # of an incidence, as in the parabola of a facet
BEFORE = 1e-4  # share of a distance by which another body must come nearer to hide a place


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


class Place(NamedTuple):
    """A place on a target in one plane, from the lower of two images and from the higher one."""

    distance: float  # from the lower image, m
    cosine: float  # of the launch angle there
    sine: float
    incidence: float  # cosine of the incidence
    r_other: float  # distance from the higher image, m
    along: float  # part of its direction along the lower one's
    across: float  # and at right angles to that, upwards
    cos_other: float  # cosine of the incidence from there; not above 0 where a convex body or a triangle turns away


class HigherView(NamedTuple):
    """What the higher of two images sees of a plane."""

    raised: float  # height above the lower image, m
    bed: BedHorizon
    zbuffer: AngularZbuffer
    cells: int


@kernel_uncounted
def list_target_echoes(arrays, knots, pair, plane, sectors, cells, x, views, zbuffers, echoes, n, sink):
    """List the echoes of targets that both images see, facet by facet, depositing them where the list gets full."""
    bodies, zbuffer = (arrays.solids, arrays.mesh, arrays.reflectivity), zbuffers[0]
    materials, knot, (one, other) = arrays.reflectivity.shape[0], -1, views
    bed, bed_of_higher = BedHorizon(x, one.z, one.horizon, knots), BedHorizon(x, other.z, other.horizon, knots)
    higher = HigherView(pair.other.height - pair.one.height, bed_of_higher, zbuffers[1], cells[1])
    seen_from = HalfPlane(plane.x, plane.y, plane.z + pair.one.height, plane.ex, plane.ey)
    for c in range(cells[0]):
        if zbuffer.nearest[c] == NO_PRIMITIVE:
            continue
        cell = load_cell(c, bodies, seen_from, False, zbuffer, bed, knot)
        primitive, body, facets, knot = cell.primitive, cell.body, cell.facets, cell.knot
        surface = TargetSurface(primitive, cell.material, materials + cell.target)
        whole = facets == 1 and is_cell_clear(zbuffer, c, bed, knot)
        for k in range(facets):
            # A cell that is whole has been met along its beginning, its middle and its end.
            facet = cell_facet(zbuffer, c, cell.source)
            if not whole:
                facet = visible_facet(primitive, cell.low, cell.high, k, facets, bed, knot)
            if not is_facet_met(facet):
                continue
            if pair.law == LIGHT and higher.raised > 0.0:
                facet, whole = _cut_facet(facet, primitive, body, higher, knot), False
            weight = _pair_weight(arrays.pattern, pair, facet, sectors)
            if not weight > 0.0:
                continue
            lean = zbuffer.lean[c] if whole else meet_primitive(primitive, facet.cosine, facet.sine)[2]
            place = _place(facet.centre, facet.cosine, facet.sine, facet.incidence, lean, higher.raised)
            if _is_seen_from_higher(place, body, higher, knot):
                span = _span_of_pair(span_of_sector(facet, cell.bounds, sectors[0], arrays.pattern), place)
                n = _list_facet(pair, facet, place, weight, span, surface, echoes, n)
        if n > ENOUGH:
            deposit_echoes(echoes, n, arrays.multipath.facets[pair.passes - 1], arrays.bin_length, pair.path, sink)
            n = 0
    return n


@inlined_uncounted
def _cut_facet(facet, primitive, body, higher, knot):
    """Part of a facet that the higher image sees, as law `light` needs it."""
    # Light counts the slant range that a facet spans, most of which may lie where it turns away from the higher image;
    # law `sonar` counts its area, seen there at a vanishing cosine.
    # At a rim, where facets begin and end, one face would be taken for another.
    inside = INSIDE * (facet.high - facet.low)
    clear, hidden = facet.low + inside, facet.high - inside
    begins = _is_seen_along(clear, primitive, body, higher, knot)
    if begins == _is_seen_along(hidden, primitive, body, higher, knot):
        return facet
    if not begins:
        clear, hidden = hidden, clear
    for _ in range(HALVINGS):
        middle = 0.5 * (clear + hidden)
        if _is_seen_along(middle, primitive, body, higher, knot):
            clear = middle
        else:
            hidden = middle
    return intersect_facet(primitive, facet.low, clear) if begins else intersect_facet(primitive, clear, facet.high)


@inlined_uncounted
def _is_seen_along(angle, primitive, body, higher, knot):
    """Whether the higher image sees the place where a launch angle of the lower one meets a primitive."""
    c, s = math.cos(angle), math.sin(angle)
    distance, cosine, lean = meet_primitive(primitive, c, s)
    if not distance < NEVER:
        return False
    return _is_seen_from_higher(_place(distance, c, s, cosine, lean, higher.raised), body, higher, knot)


@inlined_uncounted
def _place(distance, c, s, cosine, lean, raised):
    """Place at a distance and in a direction from the lower image, with both parts of the inward normal there."""
    r_other = _distance(distance, s, raised)
    per_range = 1.0 / r_other
    along, across = (distance - raised * s) * per_range, -raised * c * per_range
    return Place(distance, c, s, cosine, r_other, along, across, cosine * along + lean * across)


@inlined_uncounted
def _is_seen_from_higher(place, body, higher, knot):
    """Whether the higher image sees a place that the lower one sees: its own body, the bed and others leave it open."""
    if higher.raised == 0.0:
        return True
    if not place.cos_other > 0.0:
        return False
    level, height = place.distance * place.cosine, place.distance * place.sine - higher.raised
    if horizon_at(higher.bed, knot_before(higher.bed, level, knot), level) * level > height:
        return False
    zbuffer = higher.zbuffer
    cell = cell_towards(zbuffer.cosine, zbuffer.sine, higher.cells, level, height)
    if cell < 0 or zbuffer.nearest[cell] == NO_PRIMITIVE or zbuffer.body[zbuffer.nearest[cell]] == body:
        return True
    return zbuffer.nearness_cosine[cell] * level + zbuffer.nearness_sine[cell] * height <= 1.0 + BEFORE


@inlined_uncounted
def _list_facet(pair, facet, place, weight, span, surface, echoes, n):
    """List a facet that both images see, part by part; one part has the strength of its middle."""
    raised, per_bin, numbers = pair.other.height - pair.one.height, 1.0 / pair.bin_length, surface.numbers
    whole = _echo_of_facet(pair, facet, place, weight, surface.contributor)
    mirrored = 2.0 * place.incidence * place.cos_other - place.along
    middle, off_mirror = 0.5 * (facet.centre + place.r_other), max(0.5 - 0.5 * mirrored, 0.0)
    parts, _ = divide_facet(facet, off_mirror, numbers, whole.near * per_bin, middle * per_bin, whole.far * per_bin)
    if pair.law == LIGHT:
        return _list_light(pair, facet, whole, span, max(LIT_PARTS * parts, LEAST_LIT), surface, echoes, n)
    if parts == 1:
        value = pair_strength(place.incidence, place.cos_other, mirrored, numbers[0], numbers[1], numbers[2], pair)
        # Area dA = width · r dθ / cos α, seen at incidence α: docs/theory/sweep.md
        energy = value * facet.centre * (facet.high - facet.low) / max(place.incidence, LEAST_COSINE)
        return list_echo(echoes, n, _part_of_echo(whole, whole.near, whole.far, span, energy))
    curve, near = facet_curve(facet), whole.near
    tilt = _tilt_along(facet, curve, place)
    for k in range(parts):
        far, energy = _part_of_pair(facet, curve, tilt, k, parts, numbers, pair, raised)
        n, near = list_echo(echoes, n, _part_of_echo(whole, near, far, span, energy)), far
    return n


@inlined_uncounted
def _span_of_pair(span, place):
    """Slant ranges of a pair of images over a sector, from those of the lower image."""
    # The higher image's way changes by the part of the lower one's change that lies along it.
    ratio = 0.5 * (1.0 + place.r_other / place.distance)
    return SectorSpan(0.5 * (1.0 + place.along) * span.across, ratio * span.least, ratio * span.most)


@inlined_uncounted
def _pair_weight(pattern, pair, facet, sectors):
    """Weight of a plane for the echo of a facet, with the ratio of the spreading along both ways to the record's."""
    law, raised = pair.law, pair.other.height - pair.one.height
    x, a = facet.centre * facet.cosine, facet.centre * facet.sine
    r_other, b = _distance(facet.centre, facet.sine, raised), a - raised
    rise_one, rise_other = -a if pair.one.mirrored else a, -b if pair.other.mirrored else b
    if is_whole_beam(sectors[0]) and pattern.two_way:
        weight = paired_weight(x, (rise_one, facet.centre), (rise_other, r_other), sectors[0], pattern, law)
    else:
        weight = sector_weight(x, rise_one, facet.centre, sectors[0], pattern, law)
        if pair.orders == 2 and pattern.tabulated:
            both = weight, sector_weight(x, rise_other, r_other, sectors[1], pattern, law)
            weight = pair_response(both, x, (rise_one, facet.centre), (rise_other, r_other), sectors[0], pattern)
    return weight * spreading_ratio(facet.centre, r_other, law)


@inlined_uncounted
def _echo_of_facet(pair, facet, place, weight, contributor):
    """Slant ranges and delays of the echo of a facet, with its weight as its energy."""
    raised, rise, tilt = pair.other.height - pair.one.height, 0.0, 0.0
    rms, variance = pair.rms_height, pair.slope_variance
    if rms > 0.0 or variance > 0.0:
        drop, r, r_other = -place.distance * place.sine, place.distance, place.r_other
        rise = height_delay(pair.one, drop, r, rms) + height_delay(pair.other, drop + raised, r_other, rms)
        tilt = tilt_delay(pair.one, drop, r, variance) + tilt_delay(pair.other, drop + raised, r_other, variance)
    half = 0.5 * (facet.high - facet.low)
    near = _pair_range(facet.near, _turn(facet, -half)[1], raised)
    far = _pair_range(facet.far, _turn(facet, half)[1], raised)
    cosine = min(place.incidence, place.cos_other)
    return SurfaceEcho(near, far, weight, rise, tilt, facet.centre * facet.cosine, cosine, contributor)


@inlined_uncounted
def _part_of_echo(whole, near, far, span, energy):
    """Echo of a part of a facet, of an energy before weight and spreading."""
    start, stop = widen(near, far, span)
    return SurfaceEcho(
        start, stop, whole.energy * energy, whole.rise, whole.tilt, whole.x, whole.cosine, whole.contributor
    )


@inlined_uncounted
def _list_light(pair, facet, whole, span, parts, surface, echoes, n):
    """List a facet under law `light`: every part has the mean radiance of its ends over the slant range it spans."""
    # Towards a body's edge slant range changes as the root of the launch angle that is left, where a parabola errs, but
    # the cosines are linear in slant range.
    raised = pair.other.height - pair.one.height
    near, before = _radiance_along(surface, facet, 0.0, pair, raised)
    for k in range(parts):
        far, after = _radiance_along(surface, facet, (k + 1.0) / parts, pair, raised)
        energy = 0.5 * (before + after) * abs(far - near) / pair.bin_length
        n = list_echo(echoes, n, _part_of_echo(whole, near, far, span, energy))
        near, before = far, after
    return n


@inlined_uncounted
def _radiance_along(surface, facet, share, pair, raised):
    """Slant range and radiance for a pair of images at a share of the launch angle of a facet, intersected there."""
    # At the very ends a body may be missed, or one face be taken for another.
    angle = facet.low + min(max(share, INSIDE), 1.0 - INSIDE) * (facet.high - facet.low)
    c, s = math.cos(angle), math.sin(angle)
    distance, cosine, lean = meet_primitive(surface.primitive, c, s)
    place = _place(distance, c, s, cosine, lean, raised)
    mirrored = 2.0 * cosine * place.cos_other - place.along
    diffuse, specular, shininess = surface.numbers
    value = pair_strength(cosine, place.cos_other, mirrored, diffuse, specular, shininess, pair)
    return 0.5 * (distance + place.r_other), value


@inlined_uncounted
def _tilt_along(facet, curve, place):
    """Tilt along a facet, such that both images see its middle at the incidences that they meet it at."""
    # The parabola's slope differs from the surface's by the third derivative of slant range, which a narrow lobe
    # between two directions would notice.
    scale, left = math.sqrt(curve.gain), curve.left
    if place.across == 0.0:
        return TiltAlong(scale, 0.0, left)
    cosine = place.incidence
    # The cosine at the higher image is cosine · (along - tilt · across), as in `_part_of_pair`.
    tilt = (place.along - place.cos_other / cosine) / place.across
    shift = tilt - scale * tilt_in_plane(curve, along_curve(facet, curve, 0.5), 0.5)
    return TiltAlong(scale, shift, max(1.0 / (cosine * cosine) - 1.0 - tilt * tilt, 0.0))


@inlined_uncounted
def _part_of_pair(facet, curve, tilt_along, k, parts, numbers, pair, raised):
    """Slant range at which part k of a facet ends and its energy, out by one image and back by the other."""
    middle, end = (k + 0.5) / parts, (k + 1.0) / parts
    c, s = _turn(facet, (middle - 0.5) * curve.angle)
    r, far_sine = along_curve(facet, curve, middle), _turn(facet, (end - 0.5) * curve.angle)[1]
    far = _pair_range(along_curve(facet, curve, end), far_sine, raised)
    tilt = tilt_along.scale * tilt_in_plane(curve, r, middle) + tilt_along.shift
    cosine, per_other = 1.0 / math.sqrt(1.0 + tilt * tilt + tilt_along.left), 1.0 / _distance(r, s, raised)
    # Parts of the higher image's direction along the lower one's and across it; the normal is -(1, -tilt) in the plane.
    along, across = (r - raised * s) * per_other, -raised * c * per_other
    cos_other = cosine * (along - tilt * across)
    mirrored = 2.0 * cosine * cos_other - along
    value = pair_strength(cosine, cos_other, mirrored, numbers[0], numbers[1], numbers[2], pair)
    # Area dA = width · r dθ / cos α, seen at incidence α: docs/theory/sweep.md
    return far, value * r * curve.angle / (parts * cosine)


@inlined_uncounted
def _turn(facet, angle):
    """Cosine and sine of the launch angle of a facet's middle, turned by an angle that it fills."""
    # That is at most π/128, where the series leave out 2e-15 and 3e-13.
    squared = angle * angle
    sine = angle * (1.0 - squared * (1.0 / 6.0 - squared * (1.0 / 120.0)))
    cosine = 1.0 - squared * (0.5 - squared * (1.0 / 24.0))
    return facet.cosine * cosine - facet.sine * sine, facet.sine * cosine + facet.cosine * sine


@inlined_uncounted
def _pair_range(distance, sine, raised):
    """Slant range of an echo out by the lower image, at the sine of a launch angle, and back by the higher one."""
    return 0.5 * (distance + _distance(distance, sine, raised))


@inlined_uncounted
def _distance(distance, sine, raised):
    """Distance from the higher image to a place at a distance from the lower one and the sine of its launch angle."""
    return math.sqrt(max(distance * (distance - 2.0 * raised * sine) + raised * raised, 0.0))
