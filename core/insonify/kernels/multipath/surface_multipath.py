"""Echoes by way of the sea surface, by the sweep: of bed and targets, and of the surface itself.

Out as from one image of the sonar and back as to another, over R and R', an echo of the area dA comes at slant range
r = (R + R') / 2 with σ dA / (R² R'²), σ the bistatic strength between the two directions, if both images see it: each
has its own running horizon along one and the same profile, and its own z-buffer of targets. Two orders count twice.
What lies higher than the sonar hides bed and targets from an image, but not the surface from the sonar. Derived in
docs/theory/multipath.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from insonify.kernels.beam.azimuth_sector import is_whole_beam, raise_sector, weigh_paired_knots
from insonify.kernels.beam.knot_weights import weigh_knots
from insonify.kernels.bed.profile import Profile, empty_profile, profile_capacity
from insonify.kernels.bed.slice import slice_bed
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.range_bins import accumulate_bins
from insonify.kernels.common.types import SceneArrays
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.multipath.echo_list import (
    ENOUGH,
    EchoSink,
    deposit_echoes,
    empty_echo_list,
)
from insonify.kernels.multipath.image_sources import (
    SECOND_BOTTOM,
    SURFACE_BOTTOM,
    image_pair,
    pair_response,
    wave_advance,
)
from insonify.kernels.multipath.paired_segments import PairedSegment, SegmentLine, echo_range, list_stretch
from insonify.kernels.multipath.surface_echo import add_surface_echo
from insonify.kernels.multipath.target_multipath import list_target_echoes
from insonify.kernels.refraction.apparent_positions import COLUMNS, straight_grid
from insonify.kernels.sweep.sweep import LOWEST, aim_plane, visible_from
from insonify.kernels.sweep.target_echoes import ground_range_at, launch_angle
from insonify.kernels.sweep.visibility import NADIR
from insonify.kernels.targets.angular_zbuffer import AngularZbuffer, empty_zbuffer, fill_zbuffer
from insonify.kernels.targets.occlusion import next_visible, occluded_slopes, occlusion_of

MOST_PASSES = 2  # of the sea surface


class ImageProfile(NamedTuple):
    """A profile as one image sees it; one entry a knot."""

    z: NDArray[np.float64]  # height above the image, m
    launch: NDArray[np.float64]  # tan of the launch angle above the horizontal
    horizon: NDArray[np.float64]  # greatest launch slope so far
    weight: NDArray[np.float64]  # what the plane stands for there
    r: NDArray[np.float64]  # work space: slant range
    rise: NDArray[np.float64]  # work space: height above the sonar of where the sound set out for


class MultipathWorkspace(NamedTuple):
    """Work space for one plane as two images of the sonar see it, the lower one first."""

    profile: Profile
    images: tuple[ImageProfile, ImageProfile]
    zbuffers: tuple[AngularZbuffer, AngularZbuffer]
    echoes: NDArray[np.float64]  # a list of echoes


def empty_multipath_workspace(arrays: SceneArrays, dtype: DTypeLike = np.float32) -> MultipathWorkspace:
    """Make room for what two images see of a profile.

    Parameters
    ----------
    arrays : SceneArrays
    dtype : dtype
        Of the profile: single precision or double.

    Returns
    -------
    MultipathWorkspace
    """
    reach = arrays.bins * arrays.bin_length + wave_advance(arrays.multipath, MOST_PASSES)
    capacity = profile_capacity(reach, arrays.bed.spacing)
    images = ImageProfile(*np.zeros((6, capacity))), ImageProfile(*np.zeros((6, capacity)))
    zbuffers = empty_zbuffer(arrays.solids, arrays.mesh), empty_zbuffer(arrays.solids, arrays.mesh)
    return MultipathWorkspace(empty_profile(capacity, dtype), images, zbuffers, empty_echo_list())


@kernel
def sweep_multipath(arrays, poses, fan, image_fan, workspace, contributions, out):
    """Add the echoes by way of the sea surface to the records of pings.

    Parameters
    ----------
    arrays : SceneArrays
        Of water without refraction.
    poses : Poses
        n pings.
    fan, image_fan : AzimuthFan
        Planes of the sonar's beam, and of its image's in the sea surface.
    workspace : MultipathWorkspace
    contributions : ContributorTable
        Left alone.
    out : ndarray of float32, shape (n, 2, bins)
        Added to.
    """
    bins, line = np.zeros(arrays.bins + 2, np.int64), np.zeros(arrays.bins, np.float32)
    sink = EchoSink(bins, contributions, False)
    for ping in range(poses.x.size):
        for side in range(2):
            add_multipath(arrays, poses, ping, side, fan, image_fan, workspace, sink)
            accumulate_bins(bins, arrays.range_factor, line)
            for k in range(arrays.bins):
                out[ping, side, k] += line[k]


@kernel
def add_multipath(arrays, poses, ping, side, fan, image_fan, workspace, sink):
    """Put the echoes by way of the sea surface of one side of one ping into a difference array.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses
    ping, side : int
    fan, image_fan : AzimuthFan
        Planes of the sonar's beam, and of its image's in the sea surface.
    workspace : MultipathWorkspace
    sink : EchoSink
        Takes the echoes and, if asked to, their contributors.
    """
    x, y, z = poses.x[ping], poses.y[ping], poses.z[ping]
    for path in range(SURFACE_BOTTOM, SECOND_BOTTOM + 1):
        pair, wanted = image_pair(arrays, path, x, y, z)
        if not wanted:
            continue
        beam = image_fan if pair.one.mirrored else fan
        for k in range(beam.azimuth.size):
            add_image_plane(arrays, poses, ping, side, beam, k, pair, workspace, sink)
    if arrays.multipath.surface_echo:
        add_surface_echo(arrays, poses, ping, side, workspace.echoes, sink)


@kernel
def add_image_plane(arrays, poses, ping, side, fan, k, pair, workspace, sink):
    """Put the echoes by one pair of images in plane k of a fan into a difference array.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses
    ping, side : int
    fan : AzimuthFan
        Of the sonar, or of its image if the lower image is mirrored.
    k : int
    pair : ImagePath
    workspace : MultipathWorkspace
    sink : EchoSink
        Takes the echoes and, if asked to, their contributors.
    """
    plane, sector, _ = aim_plane(arrays, poses, ping, side, fan, k, straight_grid())
    near_field, per_height = fan.near_field[k], fan.reach[k]
    height = max(plane.z - arrays.bed.low, LOWEST)
    # If sound passes the beam only once, the beam of the higher image counts, which reaches farther out.
    one_way = arrays.pattern.tabulated and not arrays.pattern.two_way
    highest = pair.other.height if one_way else pair.one.height
    reach = min(per_height * (height + highest), pair.reach)
    profile, (x, y, z, ex, ey) = workspace.profile, plane
    count = slice_bed(arrays.bed, arrays.limits, x, y, z, ex, ey, reach, profile)
    one = raise_sector(sector, near_field * (height + pair.one.height))
    other = raise_sector(sector, near_field * (height + pair.other.height))
    cells_one = cells_other = _view_from_image(arrays, count, pair.one, plane, one, reach, workspace, 0)
    if pair.other.height > pair.one.height:
        cells_other = _view_from_image(arrays, count, pair.other, plane, other, reach, workspace, 1)
    else:
        workspace = _with_one_image(workspace)
    if is_whole_beam(one) and arrays.pattern.two_way:
        weigh_paired_knots(workspace.profile.x[:count], workspace.images, one, arrays.pattern, arrays.law)
    n = _list_bed(arrays, count, pair, (cells_one, cells_other), workspace, sink)
    if cells_one > 0:
        cells, sectors = (cells_one, cells_other), (one, other)
        n = list_target_echoes(arrays, count, pair, plane, sectors, cells, workspace, n, sink)
    _deposit(arrays, pair.passes, pair.path, workspace.echoes, n, sink)


@inlined
def _with_one_image(workspace):
    """Return the workspace of a path out and back by the same image, the lower one."""
    images, zbuffers = workspace.images, workspace.zbuffers
    return MultipathWorkspace(workspace.profile, (images[0], images[0]), (zbuffers[0], zbuffers[0]), workspace.echoes)


@inlined
def _deposit(arrays, passes, path, echoes, n, sink):
    """Deposit listed echoes, spread according to their passes of the sea surface."""
    deposit_echoes(echoes, n, arrays.multipath.facets[passes - 1], arrays.bin_length, path, sink)


@kernel
def _view_from_image(arrays, count, image, plane, sector, reach, workspace, k):
    """Fill the profile and the z-buffer of targets of image k (0 the lower); return the cells of the z-buffer."""
    profile, seen, zbuffer = workspace.profile, workspace.images[k], workspace.zbuffers[k]
    x, profile_z = profile.x, profile.z
    z, launch, horizon, r, rise = seen.z, seen.launch, seen.horizon, seen.r, seen.rise
    highest = NADIR
    for i in range(count):
        z[i] = profile_z[i] - image.height
        launch[i] = z[i] / x[i] if x[i] > 0.0 or z[i] != z[i] else NADIR
        # NaN, a hole in the bed, compares false and hides nothing.
        highest = launch[i] if launch[i] > highest else highest
        horizon[i], r[i] = highest, math.sqrt(x[i] * x[i] + z[i] * z[i])
        rise[i] = -z[i] if image.mirrored else z[i]
    weigh_knots(x[:count], rise, r, sector, arrays.pattern, arrays.law, seen.weight)
    if zbuffer.body.size == 0:
        return 0
    seen_from = HalfPlane(plane.x, plane.y, plane.z + image.height, plane.ex, plane.ey)
    table = np.zeros((2, 2, COLUMNS), np.float32)
    return max(fill_zbuffer(arrays, seen_from, sector, reach, straight_grid(), table, zbuffer), 0)


@kernel
def _list_bed(arrays, count, pair, cells, workspace, sink):
    """List the echoes of the bed that both images see; return the number of echoes not deposited yet."""
    profile, echoes, one, other = workspace.profile, workspace.echoes, workspace.images[0], workspace.images[1]
    x, slope, area, material = profile.x, profile.slope, profile.area, profile.material
    z_one, launch_one, horizon_one, r_one, weight_one = one.z, one.launch, one.horizon, one.r, one.weight
    z_other, launch_other, horizon_other = other.z, other.launch, other.horizon
    r_other, weight_other = other.r, other.weight
    table, tabulated, two_way = arrays.reflectivity, arrays.pattern.tabulated, arrays.pattern.two_way
    occlusions = occlusion_of(workspace.zbuffers[0], cells[0]), occlusion_of(workspace.zbuffers[1], cells[1])
    from_one, to_one = occluded_slopes(workspace.zbuffers[0], cells[0])
    from_other, to_other = occluded_slopes(workspace.zbuffers[1], cells[1])
    n = 0
    for i in range(count - 1):
        if not (launch_one[i + 1] > horizon_one[i] and launch_other[i + 1] > horizon_other[i]):
            continue
        near = pair_response(weight_one[i], weight_other[i], tabulated, two_way)
        far = pair_response(weight_one[i + 1], weight_other[i + 1], tabulated, two_way)
        dx, rise = x[i + 1] - x[i], np.float64(slope[i])
        beyond = 0.5 * (r_one[i] + r_other[i]) - dx * math.sqrt(1.0 + rise * rise) > pair.reach
        if beyond or not near + far > 0.0 or not area[i] > 0.0:
            continue
        row, rate = material[i], (far - near) / dx
        lower, higher = SegmentLine(z_one[i] - rise * x[i], rise), SegmentLine(z_other[i] - rise * x[i], rise)
        segment = PairedSegment(
            lower, higher, area[i], near - rate * x[i], rate, row, table[row, 0], table[row, 1], table[row, 2]
        )
        start = visible_from(lower, x[i], x[i + 1], launch_one[i], horizon_one[i])
        start = max(start, visible_from(higher, x[i], x[i + 1], launch_other[i], horizon_other[i]))
        covered = (launch_one[i + 1] > from_one) & (launch_one[i] < to_one)
        if covered or ((launch_other[i + 1] > from_other) & (launch_other[i] < to_other)):
            n = _list_visible_to_both(segment, pair, start, x[i + 1], occlusions, echoes, n)
        else:
            near, far = echo_range(segment, start), 0.5 * (r_one[i + 1] + r_other[i + 1])
            n = list_stretch(segment, pair, start, x[i + 1], near, far, echoes, n)
        if n > ENOUGH:
            _deposit(arrays, pair.passes, pair.path, echoes, n, sink)
            n = 0
    return n


@kernel
def _list_visible_to_both(segment, pair, x_from, x_to, occlusions, echoes, n):
    """List the echoes of a segment between two ground ranges that no target hides from either image."""
    low, high = launch_angle(segment.one, x_from), launch_angle(segment.one, x_to)
    while low < high:
        opened, closed = next_visible(occlusions[0], segment.one, low, high)
        if opened >= high:
            break
        start = x_from if opened <= low else max(ground_range_at(segment.one, opened), x_from)
        stop = x_to if closed >= high else min(ground_range_at(segment.one, closed), x_to)
        n = _list_visible_to_higher(segment, pair, start, stop, occlusions[1], echoes, n)
        low, x_from = closed, stop
    return n


@kernel
def _list_visible_to_higher(segment, pair, x_from, x_to, occlusion, echoes, n):
    """List the echoes of a segment between two ground ranges that no target hides from the higher image."""
    low, high = launch_angle(segment.other, x_from), launch_angle(segment.other, x_to)
    while low < high:
        opened, closed = next_visible(occlusion, segment.other, low, high)
        if opened >= high:
            break
        start = x_from if opened <= low else max(ground_range_at(segment.other, opened), x_from)
        stop = x_to if closed >= high else min(ground_range_at(segment.other, closed), x_to)
        near, far = echo_range(segment, start), echo_range(segment, stop)
        n = list_stretch(segment, pair, start, stop, near, far, echoes, n)
        low, x_from = closed, stop
    return n
