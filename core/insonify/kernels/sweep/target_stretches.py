"""Stretches of targets in one plane, facet by facet, as the sonar or two of its images see them.

Theory: docs/theory/sweep.md; by two images docs/theory/multipath.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import NOTHING, inlined_before_typing, inlined_uncounted, kernel_separate, kernel_uncounted
from insonify.kernels.beam.azimuth_sector import is_whole_beam, pair_response, paired_weight, sector_weight
from insonify.kernels.common.types import LIGHT
from insonify.kernels.geometry.cross_sections import NEVER
from insonify.kernels.sweep.bed_stretches import FINE
from insonify.kernels.sweep.facets import (
    Facet,
    SectorSpan,
    along_curve,
    divide_facet,
    facet_curve,
    is_facet_met,
    span_of_sector,
    tilt_in_plane,
    widen,
)
from insonify.kernels.sweep.image_paths import DIRECT, direct_path, path_delays, path_strength, spreading_ratio
from insonify.kernels.sweep.stretches import ENOUGH, Stretch, list_stretch, sink_stretches
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, cell_towards
from insonify.kernels.targets.apparent_targets import ApparentSource, load_apparent_source, rays_apart
from insonify.kernels.targets.primitives import (
    bisect_directions,
    intersect_primitive,
    load_primitive,
    meet_primitive,
    target_of,
)

MOST_FACETS = 64.0
HALVINGS = 10  # that find where a facet comes out of the bed
# Under law `light` the mean of both ends errs twice as much as the middle: factor of the number of parts, and the
# least number.
LIT_PARTS, LEAST_LIT = 2, 4
INSIDE = 1e-9  # share of a facet by which radiance is taken inside its ends
LEAST_COSINE = 1e-6  # of an incidence, as in the parabola of a facet
BEFORE = 1e-4  # share of a distance by which another body must come nearer to hide a place


class BedHorizon(NamedTuple):
    """A profile of the bed with its running horizon, which may hide targets."""

    x: NDArray[np.float64]  # ground range of the knots, m
    z: NDArray[np.float64]  # height above the sonar or its image, m
    slope: NDArray[np.float32]  # greatest launch slope of the bed up to each knot
    knots: int


class CellSurface(NamedTuple):
    """Surface that is the nearest in one cell of a z-buffer."""

    body: int  # row of the solids, or beyond them the triangle
    material: int  # row of the reflectivity table
    numbers: tuple[float, float, float]  # that row: Lambert's share, Phong's share and its exponent
    owner: int  # contributor
    source: ApparentSource
    bounds: tuple[float, float]  # slant ranges before and beyond which nothing of the body lies, m


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
    """What the higher of two images sees of a plane: the bed, and the cells of its z-buffer."""

    bed: BedHorizon
    cells: int
    cosine: NDArray[np.float64]
    sine: NDArray[np.float64]
    nearest: NDArray[np.int64]
    body: NDArray[np.int64]
    nearness_cosine: NDArray[np.float64]
    nearness_sine: NDArray[np.float64]


@inlined_before_typing
def view_from_higher(bed, zbuffer, cells):
    """Gather what the higher of two images sees of a plane."""
    return HigherView(
        bed, cells, zbuffer.cosine, zbuffer.sine, zbuffer.nearest, zbuffer.body, zbuffer.nearness_cosine,
        zbuffer.nearness_sine,
    )  # fmt: skip


@kernel_separate(NOTHING)
def sink_targets(bed, bodies, pattern, law, bin_length, sector, plane, zbuffer, cells, calm, rows, sink):
    """Put the stretches of targets by the direct path into a sink."""
    # What is known of the path here drops out of the code.
    path, higher = direct_path(law, bin_length, sink.labelling), view_from_higher(bed, zbuffer, cells)
    _list_targets(bed, higher, bodies, pattern, path, (sector, sector), plane, zbuffer, cells, calm, rows, sink)


@kernel_uncounted
def sink_paired_targets(bed, higher, bodies, pattern, path, sectors, plane, zbuffer, cells, waves, rows, sink):
    """Put the stretches of targets that both images of a path see into a sink.

    ``plane`` is the plane of the lower image; ``sectors`` weigh the plane as either image sees it.
    """
    _list_targets(bed, higher, bodies, pattern, path, sectors, plane, zbuffer, cells, waves, rows, sink)


@inlined_uncounted
def _list_targets(bed, higher, bodies, pattern, path, sectors, plane, zbuffer, cells, waves, rows, sink):
    """List the stretches of targets that both images of a path see, and put them into a sink."""
    knot, n, bent = -1, 0, sectors[0].bent
    # Arrays are taken out of their tuples before the loop: doing so costs more than a facet.
    (solids, mesh, table), zb = bodies, zbuffer
    edge, cosine, sine, nearest, leans = zb.edge, zb.cosine, zb.sine, zb.nearest, zb.lean
    measured = zb.near, zb.distance, zb.far, zb.incidence
    body, line, source, least, most = zb.body, zb.line, zb.source, zb.least, zb.most
    owners = solids.material, mesh.material, solids.target, mesh.target
    for cell in range(cells):
        p = nearest[cell]
        if p == NO_PRIMITIVE:
            continue
        surface = load_surface(body[p], owners, table, load_apparent_source(bent, source[p]), (least[p], most[p]))
        facet, lean = cell_facet(cell, edge, cosine, sine, measured, surface.source), leans[cell]
        facets = facet_count(facet)
        # Neighbouring cells mostly meet neighbouring places.
        farthest = max(facet.near * cosine[cell], facet.far * cosine[cell + 1])
        knot = knot_before(bed, farthest, knot)
        # A cell that is whole has been met along its beginning, its middle and its end.
        whole = facets == 1 and horizon_at(bed, knot, farthest) * cosine[cell] <= sine[cell]
        for k in range(facets):
            if not whole:
                primitive = load_primitive(solids, mesh, plane, surface.body, line[p], surface.source)
                facet = visible_facet(primitive, edge[cell], edge[cell + 1], k, facets, bed, knot)
                if path.raised > 0.0:
                    lean = meet_primitive(primitive, facet.cosine, facet.sine)[2]
            if is_facet_met(facet):
                n = list_facet(facet, lean, surface, pattern, path, sectors, higher, knot, rows, n)
        if n > ENOUGH:
            sink_stretches(rows, n, waves, path.bin_length, path.path, sink)
            n = 0
    if n > 0:
        sink_stretches(rows, n, waves, path.bin_length, path.path, sink)


@inlined_uncounted
def load_surface(body, owners, table, source, bounds):
    """Load the surface of a body or triangle."""
    solid_material, mesh_material, solid_target, mesh_target = owners
    row = target_of(solid_material, mesh_material, body)
    owner, numbers = (
        table.shape[0] + target_of(solid_target, mesh_target, body),
        (table[row, 0], table[row, 1], table[row, 2]),
    )
    return CellSurface(body, row, numbers, owner, source, bounds)


@inlined_uncounted
def cell_facet(cell, edge, cosine, sine, measured, source):
    """Facet that fills a cell of a z-buffer."""
    near, distance, far, incidence = measured
    c, s = bisect_directions(cosine[cell], sine[cell], cosine[cell + 1], sine[cell + 1])
    arc = rays_apart(source, distance[cell])
    return Facet(edge[cell], edge[cell + 1], c, s, near[cell], distance[cell], far[cell], incidence[cell], arc)


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
def facet_count(facet):
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


@inlined_uncounted
def list_facet(facet, lean, surface, pattern, path, sectors, higher, knot, rows, n):
    """List the stretches of a facet if both images see it, part by part; one part has the strength of its middle."""
    place = _see_place(facet.centre, facet.cosine, facet.sine, facet.incidence, lean, path.raised)
    weight = facet_weight(facet, surface.source.gain, place, pattern, path, sectors)
    if not (weight > 0.0 and _is_seen_from_higher(place, surface.body, path.raised, higher, knot)):
        return n
    per_bin, numbers, echo = 1.0 / path.bin_length, surface.numbers, _echo_of_facet(facet, place, weight, surface, path)
    span = _span_of_path(span_of_sector(facet, surface.bounds, sectors[0], pattern), place, path)
    near, middle, far = echo.near, 0.5 * (place.distance + place.r_other), echo.far
    mirrored = 2.0 * place.incidence * place.cos_other - place.along
    off_mirror = max(0.5 - 0.5 * mirrored, 0.0)
    parts, lobe = divide_facet(facet, off_mirror, numbers, near * per_bin, middle * per_bin, far * per_bin)
    if parts > 1:
        curve = facet_curve(facet)
        tilt = _tilt_along(facet, curve, place)
        for k in range(parts):
            far, cosine, energy = _part_of_facet(facet, curve, tilt, k, parts, near, numbers, path)
            start, stop = widen(near, far, span)
            n, near = _list_part(echo, start, stop, energy, cosine, path, rows, n), far
        return n
    # The mean of a lobe along a facet is that about the direction back to one place.
    shine = lobe if path.raised == 0.0 else numbers[1]
    value = path_strength(place.incidence, place.cos_other, mirrored, numbers[0], shine, numbers[2], path)
    # Area dA = width · r dθ / cos α, seen at incidence α: docs/theory/sweep.md
    first = second = 0.5 * value * facet.centre * (facet.high - facet.low) / max(place.incidence, LEAST_COSINE)
    if path.law == LIGHT:
        first, second = value * per_bin * abs(middle - near), value * per_bin * abs(far - middle)
    # Within a bin the place of the mean energy has the mean range factor. Without a branch, for which it is chance.
    half = 0.5 * span.across
    is_point = int((min(near, middle, far) - half) * per_bin) == int((max(near, middle, far) + half) * per_bin)
    at, (start, stop), energy = 0.25 * (near + far) + 0.5 * middle, widen(near, middle, span), first + second
    start, stop, energy = (at if is_point else start), (at if is_point else stop), (energy if is_point else first)
    n = _list_part(echo, start, stop, energy, echo.cosine, path, rows, n)
    start, stop = widen(middle, far, span)
    return _list_part(echo, start, stop, 0.0 if is_point else second, echo.cosine, path, rows, n)


@inlined_uncounted
def _list_part(echo, start, stop, energy, cosine, path, rows, n):
    """List a part of a facet, of an energy before the weight of the facet's echo."""
    x, energy = echo.x_from, echo.energy * energy
    stretch = Stretch(start, stop, energy, x, x, cosine, echo.owner, echo.rise, echo.tilt)
    return list_stretch(rows, n, stretch, path.is_detailed)


@inlined_uncounted
def _echo_of_facet(facet, place, weight, surface, path):
    """Slant ranges and delays of the echo of a facet, with its weight as its energy."""
    near, far, x = facet.near, facet.far, facet.centre * facet.cosine / surface.source.level
    if path.raised > 0.0:
        half = 0.5 * (facet.high - facet.low)
        near = _pair_range(facet.near, _turn(facet, -half)[1], path.raised)
        far = _pair_range(facet.far, _turn(facet, half)[1], path.raised)
    rise, tilt = path_delays(path, -place.distance * place.sine, place.distance, place.r_other)
    return Stretch(near, far, weight, x, x, min(place.incidence, place.cos_other), surface.owner, rise, tilt)


@inlined_uncounted
def facet_weight(facet, gain, place, pattern, path, sectors):
    """Weight of a plane for the echo of a facet, with the ratio of the spreading along both ways to the record's."""
    x, a = facet.centre * facet.cosine, facet.centre * facet.sine
    rise_one, rise_other = -a if path.one.mirrored else a, a - path.raised
    rise_other = -rise_other if path.other.mirrored else rise_other
    one, other = (rise_one, facet.centre), (rise_other, place.r_other)
    if path.path != DIRECT and is_whole_beam(sectors[0]) and pattern.two_way:
        weight = paired_weight(x, one, other, sectors[0], pattern, path.law)
    else:
        weight = sector_weight(x, rise_one, facet.centre, sectors[0], pattern, path.law)
        if path.orders == 2 and pattern.tabulated:
            both = weight, sector_weight(x, rise_other, place.r_other, sectors[1], pattern, path.law)
            weight = pair_response(both, x, one, other, sectors[0], pattern)
    return gain * weight * spreading_ratio(facet.centre, place.r_other, path.law)


@inlined_uncounted
def _span_of_path(span, place, path):
    """Slant ranges of a path over a sector, from those of the lower image."""
    if path.raised == 0.0:
        return span
    # The higher image's way changes by the part of the lower one's change that lies along it.
    ratio = 0.5 * (1.0 + place.r_other / place.distance)
    return SectorSpan(0.5 * (1.0 + place.along) * span.across, ratio * span.least, ratio * span.most)


@inlined_uncounted
def _part_of_facet(facet, curve, tilt_along, k, parts, near, numbers, path):
    """Slant range at which part k of a facet ends, the cosine of its incidence, and its energy before the weight."""
    middle, end = (k + 0.5) / parts, (k + 1.0) / parts
    r, far = along_curve(facet, curve, middle), along_curve(facet, curve, end)
    tilt = tilt_along.scale * tilt_in_plane(curve, r, middle) + tilt_along.shift
    cosine = 1.0 / math.sqrt(1.0 + tilt * tilt + tilt_along.left)
    cos_other, mirrored = cosine, 2.0 * cosine * cosine - 1.0
    if path.raised > 0.0:
        c, s = _turn(facet, (middle - 0.5) * curve.angle)
        far = _pair_range(far, _turn(facet, (end - 0.5) * curve.angle)[1], path.raised)
        # Parts of the higher image's direction along the lower one's and across it; the normal is -(1, -tilt) in the
        # plane.
        per_other = 1.0 / _distance(r, s, path.raised)
        along, across = (r - path.raised * s) * per_other, -path.raised * c * per_other
        cos_other = cosine * (along - tilt * across)
        mirrored = 2.0 * cosine * cos_other - along
    value = path_strength(cosine, cos_other, mirrored, numbers[0], numbers[1], numbers[2], path)
    if path.law == LIGHT:
        return far, cosine, value * abs(far - near) / path.bin_length
    # Area dA = width · r dθ / cos α, seen at incidence α: docs/theory/sweep.md
    return far, min(cosine, cos_other), value * r * curve.angle / (parts * cosine)


@inlined_uncounted
def _see_place(distance, c, s, cosine, lean, raised):
    """Place at a distance and in a direction from the lower image, with both parts of the inward normal there."""
    if raised == 0.0:
        return Place(distance, c, s, cosine, distance, 1.0, 0.0, cosine)
    r_other = _distance(distance, s, raised)
    per_range = 1.0 / r_other
    along, across = (distance - raised * s) * per_range, -raised * c * per_range
    return Place(distance, c, s, cosine, r_other, along, across, cosine * along + lean * across)


@inlined_uncounted
def _is_seen_from_higher(place, body, raised, higher, knot):
    """Whether the higher image sees a place that the lower one sees: its own body, the bed and others leave it open."""
    if raised == 0.0:
        return True
    if not place.cos_other > 0.0:
        return False
    level, height = place.distance * place.cosine, place.distance * place.sine - raised
    if horizon_at(higher.bed, knot_before(higher.bed, level, knot), level) * level > height:
        return False
    cell = cell_towards(higher.cosine, higher.sine, higher.cells, level, height)
    if cell < 0 or higher.nearest[cell] == NO_PRIMITIVE or higher.body[higher.nearest[cell]] == body:
        return True
    return higher.nearness_cosine[cell] * level + higher.nearness_sine[cell] * height <= 1.0 + BEFORE


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
