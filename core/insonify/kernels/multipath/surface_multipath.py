"""Echoes by way of the sea surface, by the sweep: of bed and targets, and of the surface itself.

Out as from one image of the sonar and back as to another, over R and R', an echo of the area dA comes at slant range
r = (R + R') / 2 with σ dA / (R² R'²), if both images see it; σ is the bistatic strength between the two directions.
Each image has its own running horizon along the same profile, and its own z-buffer of targets. Two orders count twice.
What lies higher than the sonar hides bed and targets from an image, but not the surface from the sonar. Derived in
docs/theory/multipath.md.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from insonify.compiler.jit import inlined, inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.beam.azimuth_sector import is_whole_beam, pair_response, raise_sector
from insonify.kernels.beam.knot_weights import weigh_knots, weigh_paired_knots
from insonify.kernels.beam.pattern import two_way_response
from insonify.kernels.beam.pattern_samples import FINE_ROOT, FINE_SINE
from insonify.kernels.bed.profile import Profile, empty_profile, padded_count, profile_capacity
from insonify.kernels.bed.slice import slice_bed
from insonify.kernels.common.range_bins import RangeBins, accumulate_bins
from insonify.kernels.common.search import last_not_above
from insonify.kernels.common.types import LIGHT, SONAR, SceneArrays, SegmentLimits
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.multipath.image_sources import PAIRS, image_pairs, plane_reach, surface_image, wave_advance
from insonify.kernels.multipath.paired_segments import PairedEchoes, deposit_paired_profile, empty_paired_echoes
from insonify.kernels.rays.launch import orient_beam
from insonify.kernels.refraction.apparent_positions import COLUMNS, straight_grid
from insonify.kernels.sweep.bed_stretches import SegmentPieces, empty_pieces, list_bed, view_bed
from insonify.kernels.sweep.image_paths import (
    SECOND_BOTTOM,
    SURFACE_BOTTOM,
    SURFACE_BOTTOM_SURFACE,
    SURFACE_ECHO,
    height_delay,
    tilt_delay,
)
from insonify.kernels.sweep.plane_errors import NODES, add_plane, finish_side, square_record
from insonify.kernels.sweep.stretches import Stretch, StretchSink, empty_stretch_list, list_stretch, sink_stretches
from insonify.kernels.sweep.sweep import (
    LOWEST,
    aim_plane,
    begin_measured,
    can_measure,
    empty_shares,
    planes_of,
    shares_planes,
)
from insonify.kernels.sweep.target_stretches import BedHorizon, sink_paired_targets, view_from_higher
from insonify.kernels.sweep.visibility import launch_slopes, running_horizon, slant_ranges
from insonify.kernels.targets.angular_zbuffer import AngularZbuffer, empty_zbuffer, fill_zbuffer

MOST_PASSES = 2  # of the sea surface
NOT_SEEN = -1  # cells of a z-buffer that is not filled yet


class ImageProfile(NamedTuple):
    """A profile as one image sees it; one entry a knot."""

    z: NDArray[np.float64]  # height above the image, m
    r: NDArray[np.float64]  # slant range, m
    rise: NDArray[np.float64]  # the same, mirrored with the image: how far the sound rises on leaving the sonar, m
    launch: NDArray[np.float32]  # tan of the launch angle above the horizontal
    horizon: NDArray[np.float32]  # greatest launch slope so far
    weight: NDArray[np.float32]  # weight of the plane there


class MultipathWorkspace(NamedTuple):
    """Work space for one plane as two images see it: the sonar itself, and one in the sea surface or in the bed."""

    profile: Profile
    images: tuple[ImageProfile, ImageProfile]
    zbuffers: tuple[AngularZbuffer, AngularZbuffer]
    segments: PairedEchoes
    table: NDArray[np.float32]  # apparent positions; unused in water without refraction
    pieces: SegmentPieces
    rows: NDArray[np.float64]  # a list of stretches


def empty_multipath_workspace(arrays: SceneArrays, dtype: DTypeLike = np.float32) -> MultipathWorkspace:
    """Make room for what two images see of a profile in single or double precision."""
    reach = arrays.bins * arrays.bin_length + wave_advance(arrays.multipath, MOST_PASSES)
    capacity = profile_capacity(reach, arrays.bed.spacing)
    lower, higher = (ImageProfile(*np.zeros((3, capacity)), *np.zeros((3, capacity), dtype)) for _ in range(2))
    zbuffers = empty_zbuffer(arrays.solids, arrays.mesh), empty_zbuffer(arrays.solids, arrays.mesh)
    segments = empty_paired_echoes(capacity, dtype)
    table = np.zeros((2, 2, COLUMNS), np.float32)
    return MultipathWorkspace(
        empty_profile(capacity, dtype), (lower, higher), zbuffers, segments, table, empty_pieces(zbuffers[0]),
        empty_stretch_list(),
    )  # fmt: skip


@kernel
def sweep_multipath(arrays, poses, laid, image_laid, workspace, contributions, sums, out, errors, bin_errors):
    """Add the echoes by way of the sea surface to the records of pings, and what their planes miss to the errors.

    Parameters
    ----------
    arrays : SceneArrays
        Of water without refraction.
    poses : Poses
        n pings.
    laid, image_laid : LaidPlanes
        Planes of the sonar's beam, and of its image's in the sea surface, of n pings.
    workspace : MultipathWorkspace
    contributions : ContributorTable
        Left alone.
    sums : PlaneSums
    out : ndarray of float32, shape (n, 2, bins)
        Added to.
    errors, bin_errors : ndarray of float64, shape (n, 2, 3, 2), and of float32, shape (n, 2, bins)
        As of `sweep_pings`; added to.
    """
    line, shares = np.zeros(arrays.bins, np.float32), empty_shares_of_images(laid, image_laid)
    sink = StretchSink(RangeBins(np.zeros(arrays.bins + 2, np.int64), arrays.range_decay), contributions, False)
    for ping in range(poses.x.size):
        for side in range(2):
            missed = errors[ping : ping + 1, side]
            add_multipath(
                arrays, poses, ping, side, laid, image_laid, workspace, sink, sums, shares, line, out[ping, side],
                missed, bin_errors[ping, side],
            )  # fmt: skip


@inlined
def empty_shares_of_images(laid, image_laid):
    """Room for the shares of the planes of a ping's beam, none of those of its image alone."""
    return np.zeros((empty_shares(laid).shape[0] + empty_shares(image_laid).shape[0], NODES + 1))


@kernel_uncounted
def add_multipath(
    arrays, poses, ping, side, laid, image_laid, workspace, sink, sums, shares, line, intensity, missed, bin_errors
):
    """Add the echoes by way of the sea surface to one side of one ping; ``missed`` has a row if errors are estimated.

    The echo of the surface itself does not count in them: it is exact, and may outweigh all others.
    """
    fan, image_fan, factor, bins = planes_of(laid, ping), planes_of(image_laid, ping), arrays.range_factor, sink.bins
    is_measured = can_measure(fan, missed)
    if is_measured:
        begin_measured(arrays, poses, ping, side, fan, shares_planes(laid, ping), sums, shares)
        sums.planes[1] = 0  # waves may shorten a path
    pairs, alike = image_pairs(arrays, poses.x[ping], poses.y[ping], poses.z[ping]), _are_alike(fan, image_fan)
    for of_image in range(2):
        beam, height = (image_fan if of_image == 1 else fan), max(poses.z[ping] - arrays.bed.low, LOWEST)
        first = fan.azimuth.size if alike and of_image == 1 else 0
        for k in range(first, beam.azimuth.size):
            # Reaches per height in both fans; 0 in that of which the plane is not one.
            mixed = fan.reach[k] if of_image == 0 else 0.0
            mirrored = image_fan.reach[k] if alike or of_image == 1 else 0.0
            reaches = (
                plane_reach(arrays, pairs[0], mixed, height),
                plane_reach(arrays, pairs[1], mirrored, height),
                plane_reach(arrays, pairs[2], mixed, height),
            )
            add_image_plane(arrays, poses, ping, side, beam, k, pairs, reaches, workspace, sink)
            if is_measured:
                row = k if of_image == 0 else fan.azimuth.size + k - first
                add_plane(sums, bins, shares[row], arrays.bins, beam.azimuth[k], beam.apart[k] or k == first)
    if is_measured:
        finish_side(sums, factor, line, missed[0], bin_errors)
    else:
        accumulate_bins(bins, factor, line)
    _add_line(line, intensity)
    if is_measured:
        square_record(sums, factor, intensity, missed[0])
    if arrays.multipath.surface_echo:
        add_surface_echo(arrays, poses, ping, side, workspace.rows, sink)
        accumulate_bins(bins, factor, line)
        _add_line(line, intensity)


@inlined_uncounted
def _add_line(line, intensity):
    for k in range(line.size):
        intensity[k] += line[k]


@inlined_uncounted
def _are_alike(fan, image_fan):
    """Whether the image's fan begins with the planes of the sonar's, as that of a top-hat and of a level fish does."""
    if fan.azimuth.size > image_fan.azimuth.size:
        return False
    alike = True
    for k in range(fan.azimuth.size):
        alike &= fan.azimuth[k] == image_fan.azimuth[k] and fan.angle[k] == image_fan.angle[k]
        alike &= fan.near_field[k] == image_fan.near_field[k]
    return alike


@inlined_uncounted
def add_image_plane(arrays, poses, ping, side, fan, k, pairs, reaches, workspace, sink):
    """Put the echoes by several pairs of images in plane k of a fan into a difference array."""
    # They share the slice of the bed, and what an image sees of it and of the targets.
    plane, sector, _ = aim_plane(arrays, poses, ping, side, fan, k, straight_grid())
    near_field, height, profile = fan.near_field[k], max(plane.z - arrays.bed.low, LOWEST), workspace.profile
    farthest = max(reaches)
    if farthest == 0.0:
        return
    x, y, z, ex, ey = plane
    shininess, bin_length, angle, misplaced, _ = arrays.limits
    # Echoes of these paths have even densities at any azimuth.
    limits = SegmentLimits(shininess, bin_length, angle, misplaced, False)
    count = slice_bed(arrays.bed, limits, x, y, z, ex, ey, farthest, profile)
    cells_of_sonar = cells_of_image = NOT_SEEN
    # The sonar makes two of the paths, its image in the surface two, its image in the bed one.
    seen_by_sonar, seen_by_image = max(reaches[0], reaches[2]), max(reaches[0], reaches[1])
    for path in range(PAIRS):
        pair, reach = pairs[path], reaches[path]
        if reach == 0.0:
            continue
        one = raise_sector(sector, near_field * (height + pair.one.height))
        other = raise_sector(sector, near_field * (height + pair.other.height))
        # Both paths before that by the bed have the sea surface's image.
        if cells_of_image == NOT_SEEN or pair.path == SECOND_BOTTOM:
            within = reach if pair.path == SECOND_BOTTOM else seen_by_image
            cells_of_image = _view_from_image(arrays, count, pair.other, plane, other, within, workspace, 1)
        if cells_of_sonar == NOT_SEEN and not pair.one.mirrored:
            cells_of_sonar = _view_from_image(arrays, count, pair.one, plane, one, seen_by_sonar, workspace, 0)
        lower = 1 if pair.one.mirrored else 0
        cells, images = (cells_of_image if lower == 1 else cells_of_sonar, cells_of_image), workspace.images
        views, zbuffers = (images[lower], images[1]), (workspace.zbuffers[lower], workspace.zbuffers[1])
        knots = _knots_within(profile.x, count, reach)
        _weigh_pair(arrays, knots, pair, one, views[0], views[1], workspace)
        if knots > 1:
            _sink_bed(arrays, sector, knots, pair, views, zbuffers, cells, workspace, sink)
        if cells[0] > 0:
            _sink_targets(arrays, knots, pair, plane, (one, other), views, zbuffers, cells, workspace, sink)


@inlined_uncounted
def _sink_bed(arrays, sector, count, pair, images, zbuffers, cells, workspace, sink):
    """Put the echoes of the bed that both images see into a sink."""
    (one, other), segments, facets = images, workspace.segments, arrays.multipath.facets[pair.passes - 1]
    lower = view_bed(one.z, one.launch, one.horizon, zbuffers[0], cells[0])
    higher = view_bed(other.z, other.launch, other.horizon, zbuffers[1], cells[1])
    hidden = lower.hidden + higher.hidden
    deposit_paired_profile(workspace.profile, count, one, other, pair, hidden, arrays, sink, segments)
    list_bed(
        workspace.profile, count, segments.cut, segments.marked, segments.weight, (lower, higher), zbuffers[0], pair,
        arrays, sector, facets, workspace.pieces, workspace.rows, sink,
    )  # fmt: skip


@inlined_uncounted
def _sink_targets(arrays, knots, pair, plane, sectors, images, zbuffers, cells, workspace, sink):
    """Put the echoes of the targets that both images see into a sink."""
    x, (one, other), facets = workspace.profile.x, images, arrays.multipath.facets[pair.passes - 1]
    bed, bodies = BedHorizon(x, one.z, one.horizon, knots), (arrays.solids, arrays.mesh, arrays.reflectivity)
    higher = view_from_higher(BedHorizon(x, other.z, other.horizon, knots), zbuffers[1], cells[1])
    seen_from = HalfPlane(plane.x, plane.y, plane.z + pair.one.height, plane.ex, plane.ey)
    pattern, rows = arrays.pattern, workspace.rows
    lower, count = zbuffers[0], cells[0]
    sink_paired_targets(bed, higher, bodies, pattern, pair, sectors, seen_from, lower, count, facets, rows, sink)


@inlined_uncounted
def _knots_within(x, count, reach):
    """Knots of a profile of which the last one alone may lie beyond a ground range."""
    return min(last_not_above(x[:count], reach) + 2, count) if count > 0 else 0


@inlined_uncounted
def _view_from_image(arrays, count, image, plane, sector, reach, workspace, k):
    """Fill the profile and the z-buffer of targets of image k (0 the sonar); return the cells of the z-buffer."""
    seen, zbuffer, pattern = workspace.images[k], workspace.zbuffers[k], arrays.pattern
    x = workspace.profile.x
    # Nothing beyond the reach of its paths returns an echo by them or hides one.
    count = _knots_within(x, count, reach)
    _view_profile(x, workspace.profile.z, padded_count(count), image, seen)
    # Without a pattern the weights of the lower image alone count; the bed's image is never the lower one.
    if pattern.tabulated or image.mirrored or k == 0:
        # Padding past the last knot may hold any number, which must not index a pattern's table.
        x, fine = x[: count if pattern.tabulated else padded_count(count)], FINE_ROOT if pattern.two_way else FINE_SINE
        if not (is_whole_beam(sector) and pattern.two_way):
            room, law = workspace.segments.room, arrays.law
            weigh_knots(x, seen.rise, seen.r, sector, pattern, law, fine, room, seen.weight)
    if zbuffer.body.size == 0:
        return 0
    seen_from = HalfPlane(plane.x, plane.y, plane.z + image.height, plane.ex, plane.ey)
    return fill_zbuffer(arrays, seen_from, sector, reach, straight_grid(), workspace.table, zbuffer)


@inlined_uncounted
def _view_profile(x, z, count, image, seen):
    """Fill the profile as an image sees it, but for its weights."""
    height, turned, above, rise = image.height, -1.0 if image.mirrored else 1.0, seen.z, seen.rise
    for i in range(count):
        above[i] = z[i] - height
        rise[i] = turned * (z[i] - height)
    slant_ranges(count, x, seen.z, seen.r)
    launch_slopes(count, x, seen.z, seen.launch)
    running_horizon(count, seen.launch, seen.horizon)


@inlined_uncounted
def _weigh_pair(arrays, count, pair, sector, one, other, workspace):
    """Weigh the knots by the response of the beam to sound out by one image and back by the other."""
    pattern, x, weight = arrays.pattern, workspace.profile.x, workspace.segments.weight
    lower, higher = one.weight, other.weight
    if is_whole_beam(sector) and pattern.two_way:
        weigh_paired_knots(x[:count], one, other, sector, pattern, arrays.law, weight)
    elif pattern.tabulated and pair.orders == 2:
        for i in range(count):
            places = (one.rise[i], one.r[i]), (other.rise[i], other.r[i])
            weight[i] = pair_response((lower[i], higher[i]), x[i], places[0], places[1], sector, pattern)
    else:
        for i in range(count):
            weight[i] = lower[i]


@kernel_uncounted
def add_surface_echo(arrays, poses, ping, side, rows, sink):
    """Add the echo of the sea surface straight above: of an image source twice as far away as the surface."""
    # It is 1 / (2d)² in the bin of the depth d, with the record's 1/d⁴ taken out; under law `light` it is the image of
    # a lamp in a mirror.
    image = surface_image(arrays, poses.z[ping])
    depth, law = image.above, arrays.law
    if not 0.0 < depth < arrays.bins * arrays.bin_length:
        return
    value = 1.0
    if arrays.pattern.tabulated:
        beam, fan = orient_beam(arrays, poses, ping, side), arrays.half_width > 0.0
        value = two_way_response(arrays.pattern, beam, fan, SONAR, 0.0, 0.0, 1.0, depth)
    energy = value if law == LIGHT else 0.25 * value * depth * depth
    rise = height_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.rms_height)
    tilt = tilt_delay(image, 2.0 * depth, 2.0 * depth, arrays.multipath.slope_variance)
    n = list_stretch(rows, 0, Stretch(depth, depth, energy, 0.0, 0.0, 1.0, 0, rise, tilt), True)
    sink_stretches(rows, n, arrays.multipath.facets[0], arrays.bin_length, SURFACE_ECHO, sink)


@kernel
def note_plane_echoes(arrays, poses, ping, side, path, fan, k, workspace, sink):
    """Note the contributors of the echoes by one path of the sea surface in plane k of a fan; return whether it exists.

    The fan is that of the sonar, or of its image for a path that leaves and returns by the surface.
    """
    if path == SURFACE_ECHO:
        if arrays.multipath.surface_echo:
            add_surface_echo(arrays, poses, ping, side, workspace.rows, sink)
        return arrays.multipath.surface_echo
    pairs = image_pairs(arrays, poses.x[ping], poses.y[ping], poses.z[ping])
    pair, height = pairs[path - SURFACE_BOTTOM], max(poses.z[ping] - arrays.bed.low, LOWEST)
    reach = plane_reach(arrays, pair, fan.reach[k], height)
    reaches = (
        reach if path == SURFACE_BOTTOM else 0.0,
        reach if path == SURFACE_BOTTOM_SURFACE else 0.0,
        reach if path == SECOND_BOTTOM else 0.0,
    )
    add_image_plane(arrays, poses, ping, side, fan, k, pairs, reaches, workspace, sink)
    return pair.farthest > 0.0
