"""Stretches of single segments of the bed: what the horizon and targets leave visible of them, and their echo.

Theory: docs/theory/sweep.md; by two images of the sonar docs/theory/multipath.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, inlined_uncounted, kernel_uncounted
from insonify.kernels.bed.profile import list_marked
from insonify.kernels.common.search import last_not_above
from insonify.kernels.common.types import LIGHT
from insonify.kernels.sweep.image_paths import DIRECT, path_delays, path_strength, spreading_ratio
from insonify.kernels.sweep.stretches import ENOUGH, Stretch, list_stretch, sink_stretches
from insonify.kernels.targets.angular_zbuffer import NO_PRIMITIVE, AngularZbuffer
from insonify.kernels.targets.occlusion import (
    Occlusion,
    hiding_cells,
    is_hidden,
    next_visible,
    occluded_slopes,
    occlusion_of,
)
from insonify.kernels.targets.primitives import target_of

FINE = 0.02  # length, as a share of its range, up to which the energy of a part spreads evenly over its bins
MOST_PARTS = 4096
MOST_NEWTON = 40  # steps that find where a segment comes nearest to both images
SAME_PLACE = 1e-10  # share of a stretch below which a step ends the search
NO_TARGET = -2  # in place of a target's index
EACH_CELL = 3  # pieces of a segment that one cell of a z-buffer may make


class BedSegment(NamedTuple):
    """One segment of the bed: the line z = offset + slope·x in the plane, its tilt and its material."""

    offset: float
    slope: float
    area: float  # 1 + |∇z|²
    facing: float  # -r√area cosα at slant range r and incidence α, m; the offset itself where sound goes straight
    weight: float  # weight of its plane (along-track width, or share of the beam), extrapolated linearly to nadir
    weight_rate: float  # by which that grows per metre of ground range
    range_ratio: float  # apparent ground range over the true one
    material: int  # row of the reflectivity table
    diffuse: float
    specular: float
    shininess: float


class SegmentLine(NamedTuple):
    """The line of a segment in the plane, as one image sees it: z = offset + slope·x."""

    offset: float
    slope: float


class SegmentPieces(NamedTuple):
    """Pieces of one segment of the bed by what hides them, one entry each, in the order of their ground ranges."""

    x_from: NDArray[np.float64]  # ground range of the ends, m
    x_to: NDArray[np.float64]
    hider: NDArray[np.int64]  # index of the declared target that hides it, NO_TARGET where none does


def empty_pieces(zbuffer: AngularZbuffer) -> SegmentPieces:
    """Make room for the pieces of any segment."""
    room = EACH_CELL * (zbuffer.edge.size + 1)
    return SegmentPieces(np.zeros(room), np.zeros(room), np.zeros(room, np.int64))


class BedView(NamedTuple):
    """What the sonar or one of its images sees of a profile, and the cells of its z-buffer that hide it."""

    z: NDArray[np.float64]  # height of the knots above the image, m
    launch: NDArray[np.float32]  # tan of their launch angle above the horizontal
    horizon: NDArray[np.float32]  # greatest launch slope up to each
    hidden: tuple[float, float]  # launch slopes between which targets may hide the bed
    occlusion: Occlusion


@inlined_uncounted
def view_bed(z, launch, horizon, zbuffer, cells):
    """Gather what an image sees of a profile."""
    return BedView(z, launch, horizon, occluded_slopes(zbuffer, cells), occlusion_of(zbuffer, cells))


@inlined_uncounted
def load_segment(i, x, z, slope, area, material, bending, weights, table, sector):
    """Load segment i of a profile, with the heights of its knots above an image; ``bending`` is of refracting water."""
    row, rise = material[i], slope[i]
    at_nadir, rate, offset, ratio = 1.0, 0.0, z[i] - rise * x[i], 1.0
    if sector.angle > 0.0 or sector.tabulated or sector.bent:
        rate = (np.float64(weights[i + 1]) - weights[i]) / (x[i + 1] - x[i])
        at_nadir = weights[i] - rate * x[i]
    facing = np.float64(offset)
    if sector.bent:
        facings, ratios = bending
        facing, ratio = np.float64(facings[i]), 0.5 * (ratios[i] + ratios[i + 1])
    numbers = table[row, 0], table[row, 1], table[row, 2]
    return BedSegment(offset, rise, area[i], facing, at_nadir, rate, ratio, row, *numbers)


@inlined_uncounted
def visible_from(offset, slope, x_from, x_to, launch, horizon):
    """Ground range from which a segment's line rises above the horizon: offset / x + slope = horizon."""
    if horizon > launch:
        return min(max(offset / (horizon - slope), x_from), x_to)
    return x_from


@inlined_uncounted
def list_bed(profile, count, marks, indices, weights, views, zbuffer, path, arrays, sector, waves, pieces, rows, sink):
    """List the stretches of the marked segments that both images of a path see, and put them into a sink."""
    marked, n, (one, other), table = list_marked(marks, count - 1, indices), 0, views, arrays.reflectivity
    # Arrays are taken out of their tuples before the loop: doing so costs as much as a segment.
    x, slope, area, material, bending = (
        profile.x,
        profile.slope,
        profile.area,
        profile.material,
        (profile.facing, profile.range_ratio),
    )
    z, launch, horizon, launch_other, horizon_other = one.z, one.launch, one.horizon, other.launch, other.horizon
    (hides_from, hides_to), (other_from, other_to) = one.hidden, other.hidden
    occlusions, raised = (one.occlusion, other.occlusion), path.raised
    hidden_row = sink.contributions.first_hidden if sink.labelling and path.path == DIRECT else -1
    owners = zbuffer.nearest, zbuffer.body, arrays.solids.target, arrays.mesh.target
    for k in range(marked):
        i = indices[k]
        segment = load_segment(i, x, z, slope, area, material, bending, weights, table, sector)
        start = visible_from(segment.offset, segment.slope, x[i], x[i + 1], launch[i], horizon[i])
        covered = (launch[i + 1] > hides_from) & (launch[i] < hides_to)
        if raised > 0.0:
            offset = segment.offset - raised
            risen = visible_from(offset, segment.slope, x[i], x[i + 1], launch_other[i], horizon_other[i])
            start = max(start, risen)
            covered |= (launch_other[i + 1] > other_from) & (launch_other[i] < other_to)
        # Most of what is covered is hidden whole. The call for the rest costs more than this test.
        if covered and hidden_row < 0 and is_hidden(occlusions[0], segment, start, x[i + 1]):
            continue
        if covered:
            n = _list_pieces(segment, path, start, x[i + 1], occlusions, owners, pieces, hidden_row, rows, n)
        else:
            n = list_bed_stretch(segment, path, start, x[i + 1], segment.material, rows, n)
        if n > ENOUGH:
            sink_stretches(rows, n, waves, path.bin_length, path.path, sink)
            n = 0
    if n > 0:
        sink_stretches(rows, n, waves, path.bin_length, path.path, sink)


@kernel_uncounted
def _list_pieces(segment, path, x_from, x_to, occlusions, owners, pieces, hidden_row, rows, n):
    """List the stretches of a segment that targets leave visible; with a row for hidden ones, those that they hide."""
    line = SegmentLine(segment.offset - path.raised, segment.slope)
    if path.raised > 0.0 and is_hidden(occlusions[1], line, x_from, x_to):
        return n
    for k in range(split_segment(segment, x_from, x_to, occlusions[0], owners, hidden_row >= 0, pieces)):
        start, stop, hider = pieces.x_from[k], pieces.x_to[k], pieces.hider[k]
        owner = segment.material if hider == NO_TARGET else hidden_row + hider
        low, high, begin, end = 0.0, 1.0, start, stop
        if path.raised > 0.0:
            low, high = launch_angle(line, start), launch_angle(line, stop)
        while low < high:
            closed = high
            if path.raised > 0.0:
                low, closed, begin, end = _next_stretch(occlusions[1], line, low, high, start, stop)
            if low < high:
                n = list_bed_stretch(segment, path, begin, end, owner, rows, n)
            low, start = closed, end
    return n


@inlined_uncounted
def split_segment(segment, x_from, x_to, occlusion, owners, with_hidden, pieces):
    """Split a segment by the targets that hide it; return the number of pieces, with or without the hidden ones."""
    if occlusion.edge.size == 0:
        return _add_piece(pieces, 0, x_from, x_to, NO_TARGET)
    n, (first, end) = 0, hiding_cells(occlusion, segment, x_from, x_to)
    if first < end:
        hider = _only_hider(owners, first, end) if with_hidden else NO_TARGET
        if not with_hidden or hider != NO_TARGET:
            return _add_hidden(pieces, 0, x_from, x_to, hider)
    low, high = launch_angle(segment, x_from), launch_angle(segment, x_to)
    while low < high:
        opened, closed, start, stop = _next_stretch(occlusion, segment, low, high, x_from, x_to)
        if opened > low and with_hidden:
            n = _split_hidden(segment, low, opened, x_from, start, occlusion.edge, owners, pieces, n)
        if opened < high:
            n = _add_piece(pieces, n, start, stop, NO_TARGET)
        low, x_from = closed, stop
    return n


@inlined_uncounted
def _hider_in(owners, cell):
    """Index of the declared target that is nearest in a cell of a z-buffer, NO_TARGET in an empty one."""
    nearest, body, solid_target, mesh_target = owners
    return NO_TARGET if nearest[cell] == NO_PRIMITIVE else target_of(solid_target, mesh_target, body[nearest[cell]])


@inlined_uncounted
def _only_hider(owners, first, end):
    """Target that is the nearest in all of some cells, if one alone is."""
    hider = _hider_in(owners, first)
    for cell in range(first + 1, end):
        if _hider_in(owners, cell) != hider:
            return NO_TARGET
    return hider


@kernel_uncounted
def _split_hidden(segment, low, high, x_from, x_to, edge, owners, pieces, n):
    """Split a stretch that targets hide between two launch angles, by the target that is nearest in each cell."""
    cell, hider = max(last_not_above(edge, low), 0), NO_TARGET
    while low < high and cell + 1 < edge.size:
        own = _hider_in(owners, cell)
        if own != hider:
            start = min(max(_ground_range_at(segment, low), x_from), x_to)
            n, x_from, hider = _add_hidden(pieces, n, x_from, start, hider), start, own
        low, cell = edge[cell + 1], cell + 1
    stop = x_to if low >= high else min(max(_ground_range_at(segment, low), x_from), x_to)
    return _add_hidden(pieces, n, x_from, stop, hider)


@inlined_uncounted
def _add_hidden(pieces, n, x_from, x_to, hider):
    """Append a piece that a target hides, if one does; return the number of pieces."""
    return n if hider == NO_TARGET else _add_piece(pieces, n, x_from, x_to, hider)


@inlined_uncounted
def _add_piece(pieces, n, x_from, x_to, hider):
    """Append a piece; return the number of pieces."""
    pieces.x_from[n], pieces.x_to[n], pieces.hider[n] = x_from, x_to, hider
    return n + 1


@inlined_uncounted
def _next_stretch(occlusion, line, low, high, x_from, x_to):
    """Launch angles and ground ranges between which targets leave the next stretch of a segment visible."""
    # The search runs from the launch angle ``low`` at ``x_from`` to ``high`` at ``x_to``; targets hide what lies before
    # the stretch. A stretch that begins at ``high`` does not exist.
    opened, closed = next_visible(occlusion, line, low, high)
    start = x_from if opened <= low else x_to
    if low < opened < high:
        start = min(max(_ground_range_at(line, opened), x_from), x_to)
    stop = x_to if closed >= high else min(_ground_range_at(line, closed), x_to)
    return opened, closed, start, stop


@inlined_uncounted
def launch_angle(line, x):
    """Launch angle to a segment at a ground range."""
    return math.atan2(line.offset + line.slope * x, x)


@inlined_uncounted
def _ground_range_at(line, angle):
    """Ground range at which a launch angle meets a segment's line."""
    return line.offset / (math.tan(angle) - line.slope)


@inlined_uncounted
def list_bed_stretch(segment, path, x_from, x_to, owner, rows, n):
    """List the echo of a stretch of a segment, in parts short against their range."""
    near, far = echo_range(segment, path.raised, x_from), echo_range(segment, path.raised, x_to)
    squared = (x_to - x_from) * (x_to - x_from) * (1.0 + segment.slope * segment.slope)
    if squared <= min(abs(far - near), FINE * FINE * near) * near:
        # Short, and far from the foot of its perpendicular: one even density will do.
        return _list_part(segment, path, x_from, x_to, near, far, owner, rows, n) if x_to > x_from else n
    # Along each side of the foot slant range grows or falls.
    foot = nearest_ground_range(segment, path.raised, x_from, x_to)
    for start, stop in ((x_from, foot), (foot, x_to)):
        if stop > start:
            near, nearest = echo_range(segment, path.raised, start), echo_range(segment, path.raised, foot)
            length, nearest = (
                (stop - start) * math.sqrt(1.0 + segment.slope * segment.slope),
                max(nearest, path.bin_length),
            )
            parts = 1 + int(min(length / (FINE * nearest), MOST_PARTS - 1.0))
            dx = (stop - start) / parts
            for k in range(parts):
                begin = start + k * dx
                far = echo_range(segment, path.raised, begin + dx)
                n, near = _list_part(segment, path, begin, begin + dx, near, far, owner, rows, n), far
    return n


@inlined
def _list_part(segment, path, x_from, x_to, near, far, owner, rows, n):
    """List one part; its energy is spread evenly over the slant ranges that it spans, ``near`` to ``far``."""
    x, root = 0.5 * (x_from + x_to), math.sqrt(segment.area)
    a = segment.offset + segment.slope * x
    r = math.sqrt(x * x + a * a)
    cosine, r_other, cos_other, mirrored = -segment.facing / (r * root), r, 1.0, 1.0  # docs/theory/sweep.md
    if path.raised > 0.0:
        b = a - path.raised
        r_other = math.sqrt(x * x + b * b)
        cos_other = -(segment.offset - path.raised) / (r_other * root)
        mirrored = 2.0 * cosine * cos_other - (x * x + a * b) / (r * r_other)
    if path.path != DIRECT and path.raised - a <= path.other.above:
        return n  # land
    value = path_strength(cosine, cos_other, mirrored, segment.diffuse, segment.specular, segment.shininess, path)
    value *= (segment.weight + segment.weight_rate * x) * spreading_ratio(r, r_other, path.law)
    energy = value * abs(far - near) / path.bin_length if path.law == LIGHT else value * root * (x_to - x_from)
    rise, tilt = path_delays(path, -a, r, r_other)
    ends, least = (x_from / segment.range_ratio, x_to / segment.range_ratio), min(cosine, cos_other)
    return list_stretch(
        rows, n, Stretch(near, far, energy, ends[0], ends[1], least, owner, rise, tilt), path.is_detailed
    )


@inlined
def echo_range(segment, raised, x):
    """Slant range of a segment at a ground range: half the way by both images."""
    z = segment.offset + segment.slope * x
    r = math.sqrt(x * x + z * z)
    return r if raised == 0.0 else 0.5 * (r + math.sqrt(x * x + (z - raised) * (z - raised)))


@inlined_uncounted
def nearest_ground_range(segment, raised, x_from, x_to):
    """Ground range at which a stretch of a segment comes nearest: slant range falls towards it and grows beyond."""
    if raised == 0.0:
        return min(max(-segment.slope * segment.offset / (1.0 + segment.slope * segment.slope), x_from), x_to)
    return _nearest_to_both(segment, raised, x_from, x_to)


@kernel_uncounted
def _nearest_to_both(segment, raised, x_from, x_to):
    """Ground range at which the echo of a segment by two images comes nearest."""
    if _range_rate(segment, raised, x_from)[0] >= 0.0:
        return x_from
    if _range_rate(segment, raised, x_to)[0] <= 0.0:
        return x_to
    low, high, x = x_from, x_to, 0.5 * (x_from + x_to)
    for _ in range(MOST_NEWTON):
        rate, growth = _range_rate(segment, raised, x)
        if rate < 0.0:
            low = x
        else:
            high = x
        nearer = x - rate / growth
        nearer = nearer if low < nearer < high else 0.5 * (low + high)
        if abs(nearer - x) <= SAME_PLACE * (x_to - x_from):
            return nearer
        x = nearer
    return x


@inlined_uncounted
def _range_rate(segment, raised, x):
    """Twice the rate at which the slant range of the echo grows with ground range, and how fast that grows."""
    slope, tilt = segment.slope, 1.0 + segment.slope * segment.slope
    a = segment.offset + slope * x
    b = a - raised
    per_one, per_other = 1.0 / math.sqrt(x * x + a * a), 1.0 / math.sqrt(x * x + b * b)
    rate_one, rate_other = (x + slope * a) * per_one, (x + slope * b) * per_other
    growth = (tilt - rate_one * rate_one) * per_one + (tilt - rate_other * rate_other) * per_other
    return rate_one + rate_other, growth


@inlined
def ground_range_at_slant(segment, r, outward):
    """Ground range at which a segment's line has a slant range, beyond the foot of its perpendicular or before it."""
    tilt = 1.0 + segment.slope * segment.slope
    foot = -segment.slope * segment.offset / tilt
    nearest_squared = segment.offset * segment.offset / tilt
    away = math.sqrt(max(r * r - nearest_squared, 0.0) / tilt)
    return foot + away if outward else foot - away
