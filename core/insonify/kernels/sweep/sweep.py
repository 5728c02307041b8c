"""The sweep: every plane is walked outward from nadir with one running horizon, its echoes spread over range bins.

Each visible stretch of a segment spreads its energy evenly over the slant range it covers: a density that steps up
where the stretch begins and down where it ends. The steps go into a difference array of integers, one event per knot,
and a prefix sum turns them into bins. Integers cancel exactly, so that a bin without energy is exactly zero and the sum
is the same in any order. Whole segments of oblique planes have linear densities. Spreading and absorption multiply
afterwards; their change within a bin enters by the shares of each step. Derived in docs/theory/sweep.md.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from insonify.compiler.jit import inlined, inlined_before_typing, inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.beam.azimuth_sector import AzimuthSector
from insonify.kernels.bed.grid import is_oblique
from insonify.kernels.bed.profile import Profile, empty_profile, profile_capacity
from insonify.kernels.bed.slice import slice_bed, snap_to_grid
from insonify.kernels.common.contributors import ContributorTable, empty_contributor_table
from insonify.kernels.common.range_bins import RangeBins, accumulate_bins
from insonify.kernels.common.types import PORT, SceneArrays
from insonify.kernels.geometry.cross_sections import HalfPlane
from insonify.kernels.refraction.apparent_positions import (
    ApparentTables,
    apply_apparent_positions,
    prepare_table,
    straight_grid,
)
from insonify.kernels.sweep.bed_stretches import SegmentPieces, empty_pieces, list_bed, view_bed
from insonify.kernels.sweep.image_paths import DIRECT, direct_path
from insonify.kernels.sweep.plane_errors import (
    LEAST_PLANES,
    NODES,
    add_plane,
    begin_side,
    divide_bins,
    finish_side,
    share_planes,
    square_record,
    weigh_plane,
)
from insonify.kernels.sweep.segment_densities import deposit_densities, deposit_linear_densities
from insonify.kernels.sweep.stretches import StretchSink, empty_stretch_list, note_whole_segments
from insonify.kernels.sweep.target_stretches import BedHorizon, sink_targets
from insonify.kernels.sweep.visibility import SegmentEchoes, empty_segment_echoes, find_visible_echoes
from insonify.kernels.targets.angular_zbuffer import AngularZbuffer, empty_zbuffer, fill_zbuffer
from insonify.kernels.targets.occlusion import occluded_slopes

LOWEST = 1e-3  # m, for a height of a sonar that is below all of the bed


class AzimuthFan(NamedTuple):
    """Planes of a beam, one entry each, mirrored to both sides."""

    azimuth: NDArray[np.float64]  # from athwart towards the bow, rad
    s_low: NDArray[np.float64]
    s_high: NDArray[np.float64]
    angle: NDArray[np.float64]
    far_angle: NDArray[np.float64]
    near_field: NDArray[np.float64]  # per metre of the sonar's height above the lowest bed
    reach: NDArray[np.float64]  # greatest ground range in the plane inside the beam, per metre of that height
    apart: NDArray[np.bool_]  # whether a border of a target lies between the plane and the one before it

    def take(self, which: Any) -> "AzimuthFan":
        """Return some of the planes, by a mask, by their places or by a slice."""
        columns: list[Any] = [np.ascontiguousarray(column[which]) for column in self]
        return AzimuthFan(*columns)


class LaidPlanes(NamedTuple):
    """Planes of the beams of pings; pings that are alike share theirs."""

    fan: AzimuthFan  # planes of all pings, those of each together in the order of their azimuths
    first: NDArray[np.int64]  # (n,) first plane of each ping
    last: NDArray[np.int64]  # (n,) plane after its last one

    def of_pings(self, which: Any) -> "LaidPlanes":
        """Return the planes of some pings, by their places, a mask or a slice."""
        return LaidPlanes(self.fan, self.first[which], self.last[which])

    def of(self, ping: int) -> AzimuthFan:
        """Return the planes of one ping."""
        return self.fan.take(slice(self.first[ping], self.last[ping]))


class SweepWorkspace(NamedTuple):
    """Work space for one plane, and the contributors to one side of a ping if they are noted."""

    profile: Profile
    echoes: SegmentEchoes
    zbuffer: AngularZbuffer
    table: NDArray[np.float32]  # apparent positions from the height of one ping, (rows, columns, 4)
    pieces: SegmentPieces
    rows: NDArray[np.float64]  # a list of stretches
    calm: NDArray[np.float64]  # (0, 4) facets of the sea surface: the direct path meets none
    contributions: ContributorTable
    labelling: bool  # whether contributors are noted


def empty_sweep_workspace(
    arrays: SceneArrays,
    apparent: ApparentTables,
    dtype: DTypeLike = np.float32,
    contributions: ContributorTable | None = None,
) -> SweepWorkspace:
    """Make room for the planes of a scene, in single precision or, to measure its error, in double."""
    capacity = profile_capacity(apparent.stretch * arrays.bins * arrays.bin_length, arrays.bed.spacing)
    profile, echoes = empty_profile(capacity, dtype), empty_segment_echoes(capacity, arrays.bins, dtype)
    table, zbuffer = np.zeros(apparent.tables.shape[1:], np.float32), empty_zbuffer(arrays.solids, arrays.mesh)
    noted = empty_contributor_table(0, 0, 1, 0) if contributions is None else contributions
    rows, calm, labelling = empty_stretch_list(), np.zeros((0, 4)), contributions is not None
    return SweepWorkspace(profile, echoes, zbuffer, table, empty_pieces(zbuffer), rows, calm, noted, labelling)


@inlined_uncounted
def view_plane(arrays, plane, sector, reach, grid, workspace):
    """Slice what one plane cuts, and find its visible parts; return the cells of the z-buffer and the knots."""
    profile, echoes, zbuffer, table = workspace.profile, workspace.echoes, workspace.zbuffer, workspace.table
    # A scene without bodies skips the call, which alone costs some 0.3 µs a plane.
    cells = fill_zbuffer(arrays, plane, sector, reach, grid, table, zbuffer) if zbuffer.body.size > 0 else 0
    hidden_from, hidden_to = occluded_slopes(zbuffer, cells)
    count = slice_bed(arrays.bed, arrays.limits, plane.x, plane.y, plane.z, plane.ex, plane.ey, reach, profile)
    if count > 1:
        if sector.bent:
            apply_apparent_positions(table, grid, sector.angle == 0.0, profile, count)
        find_visible_echoes(profile, count, plane, arrays, sector, hidden_from, hidden_to, echoes)
    return cells, count


@inlined_uncounted
def sweep_plane(arrays, plane, sector, reach, grid, workspace, bins):
    """Put the echoes of the bed and of the targets that one plane cuts into a difference array, and note them."""
    cells, count = view_plane(arrays, plane, sector, reach, grid, workspace)
    sink = StretchSink(bins, workspace.contributions, workspace.labelling)
    if count > 1:
        _sweep_bed(arrays, plane, sector, cells, count, workspace, sink)
    if cells > 0:
        profile, zbuffer, calm, rows = workspace.profile, workspace.zbuffer, workspace.calm, workspace.rows
        bed = BedHorizon(profile.x, profile.z, workspace.echoes.horizon, count)
        bodies, law, bin_length = (arrays.solids, arrays.mesh, arrays.reflectivity), arrays.law, arrays.bin_length
        # What is not needed is not handed over.
        sink_targets(bed, bodies, arrays.pattern, law, bin_length, sector, plane, zbuffer, cells, calm, rows, sink)
    return cells, count


@inlined_uncounted
def _sweep_bed(arrays, plane, sector, cells, count, workspace, sink):
    """Put the echoes of all visible segments of a profile into a sink."""
    profile, echoes, zbuffer, bin_length = workspace.profile, workspace.echoes, workspace.zbuffer, arrays.bin_length
    if sink.labelling:
        # Without refraction there are no ratios.
        ratios = profile.range_ratio[: profile.range_ratio.size if sector.bent else 0]
        note_whole_segments(
            profile.x, echoes.r, ratios, profile.material, echoes.cos_squared, echoes.energy, count, DIRECT,
            bin_length, sink.contributions,
        )  # fmt: skip
    if is_oblique(plane.ex, plane.ey):
        deposit_linear_densities(count, echoes, bin_length, sink.bins)
    else:
        deposit_densities(count, echoes, bin_length, sink.bins)
    view = view_bed(profile.z, echoes.launch, echoes.horizon, zbuffer, cells)
    path, pieces, rows = direct_path(arrays.law, bin_length, sink.labelling), workspace.pieces, workspace.rows
    list_bed(
        profile, count, echoes.cut, echoes.marked, echoes.weight, (view, view), zbuffer, path, arrays, sector,
        workspace.calm, pieces, rows, sink,
    )  # fmt: skip


@kernel
def sweep_pings(arrays, poses, laid, apparent, workspace, sums, out, errors, bin_errors):
    """Sweep every plane of every ping, and estimate what their sum misses.

    Parameters
    ----------
    arrays : SceneArrays
    poses : Poses
        n pings.
    laid : LaidPlanes
        Of n pings.
    apparent : ApparentTables
        Of water that refracts.
    workspace : SweepWorkspace
    sums : PlaneSums
    out : ndarray of float32, shape (n, 2, bins)
        Takes the intensity of both sides.
    errors : ndarray of float64, shape (n, 2, 3, 2)
        Takes by region the squares of the error and of the record over the record of a level bed; with no pings, no
        error is estimated.
    bin_errors : ndarray of float32, shape (n, 2, bins)
        Takes the error of every bin as an intensity; without bins, none is found.
    """
    bins = RangeBins(np.zeros(arrays.bins + 2, np.int64), arrays.range_decay)
    _sweep_all(arrays, poses, laid, apparent, workspace, bins, sums, empty_shares(laid), out, errors, bin_errors)


@inlined_uncounted
def _sweep_all(arrays, poses, laid, apparent, workspace, bins, sums, shares, out, errors, bin_errors):
    """Sweep every plane of every ping, without counting references."""
    for ping in range(poses.x.size):
        grid = prepare_table(apparent, poses.z[ping], workspace.table)
        for side in range(2):
            missed = errors[ping : ping + 1, side]
            sweep_side(
                arrays, poses, ping, side, laid, grid, workspace, bins, sums, shares, out[ping, side], missed,
                bin_errors[ping, side],
            )  # fmt: skip


@inlined_uncounted
def sweep_side(arrays, poses, ping, side, laid, grid, workspace, bins, sums, shares, intensity, missed, bin_errors):
    """Sweep the planes of one side of one ping; ``missed`` has a row if errors are estimated."""
    fan = planes_of(laid, ping)
    is_measured = can_measure(fan, missed)
    if is_measured:
        begin_measured(arrays, poses, ping, side, fan, shares_planes(laid, ping), sums, shares)
    for k in range(fan.azimuth.size):
        plane, sector, reach = aim_plane(arrays, poses, ping, side, fan, k, grid)
        sweep_plane(arrays, plane, sector, reach, grid, workspace, bins)
        if is_measured:
            end = reach_in_bins(arrays, plane.z, reach)
            add_plane(sums, bins, shares[k], end, fan.azimuth[k], fan.apart[k])
    if is_measured:
        missed[0] = 0.0
        finish_side(sums, arrays.range_factor, intensity, missed[0], bin_errors)
        square_record(sums, arrays.range_factor, intensity, missed[0])
    else:
        accumulate_bins(bins, arrays.range_factor, intensity)


@inlined_before_typing
def planes_of(laid, ping):
    """Planes of one ping."""
    a, b, fan = laid.first[ping], laid.last[ping], laid.fan
    return AzimuthFan(
        fan.azimuth[a:b], fan.s_low[a:b], fan.s_high[a:b], fan.angle[a:b], fan.far_angle[a:b], fan.near_field[a:b],
        fan.reach[a:b], fan.apart[a:b],
    )  # fmt: skip


@inlined_uncounted
def shares_planes(laid, ping):
    """Whether a ping has the planes of the one before."""
    return ping > 0 and laid.first[ping] == laid.first[ping - 1] and laid.last[ping] == laid.last[ping - 1]


@inlined
def empty_shares(laid):
    """Room for the shares of the planes of a ping."""
    most = 0
    for ping in range(laid.first.size):
        most = max(most, laid.last[ping] - laid.first[ping])
    return np.zeros((most, NODES + 1))


@inlined_uncounted
def can_measure(fan, errors):
    """Whether errors are to be estimated, and a fan has enough planes for it."""
    return errors.shape[0] > 0 and fan.azimuth.size >= LEAST_PLANES


@inlined_uncounted
def reach_in_bins(arrays, z, reach):
    """Bin beyond which a plane of a ground range has no echoes of a bed within its heights."""
    farthest = math.hypot(reach + 2.0 * arrays.bed.spacing, z - arrays.bed.low)
    return np.int64(farthest / arrays.bin_length) + 2


@kernel_uncounted
def begin_measured(arrays, poses, ping, side, fan, is_fan_shared, sums, shares):
    """Clear the sums of a side, and weigh its planes unless those of the ping before are weighed alike."""
    begin_side(sums)
    if side == PORT and is_fan_shared and _is_posed_alike(poses, ping):
        return
    if side != PORT and poses.roll[ping] == 0.0:
        return
    divide_bins(sums, arrays, poses.z[ping])
    for k in range(fan.azimuth.size):
        _, sector, _ = aim_plane(arrays, poses, ping, side, fan, k, straight_grid())
        weigh_plane(sums, arrays, poses.z[ping], sector, shares[k])
    share_planes(sums, shares[: fan.azimuth.size])
    shares[fan.azimuth.size :] = 0.0  # rows of planes of an image alone, which have none


@inlined_uncounted
def _is_posed_alike(poses, ping):
    """Whether a ping has the height and attitude of the one before, without roll."""
    alike = poses.z[ping] == poses.z[ping - 1] and poses.pitch[ping] == poses.pitch[ping - 1]
    return alike and poses.roll[ping] == 0.0 and poses.roll[ping - 1] == 0.0


@inlined_uncounted
def aim_plane(arrays, poses, ping, side, fan, k, grid):
    """Orient one plane of a ping's beam."""
    height = max(poses.z[ping] - arrays.bed.low, LOWEST)
    ahead_x, ahead_y = snap_to_grid(math.cos(poses.heading[ping])), snap_to_grid(math.sin(poses.heading[ping]))
    abeam = 1.0 if side == PORT else -1.0
    # Abeam, turned towards the bow by the plane's azimuth.
    c, s = math.cos(fan.azimuth[k]), math.sin(fan.azimuth[k])
    ex, ey = ahead_x * s - abeam * ahead_y * c, ahead_y * s + abeam * ahead_x * c
    # The fish's axis, and its own side and up, from heading, pitch (bow up) and roll (port up).
    cos_pitch, sin_pitch = math.cos(poses.pitch[ping]), math.sin(poses.pitch[ping])
    cos_roll, sin_roll = math.cos(poses.roll[ping]), abeam * math.sin(poses.roll[ping])
    side_x, side_z = cos_roll * c - sin_roll * sin_pitch * s, sin_roll * cos_pitch
    up_x, up_z = -cos_roll * sin_pitch * s - sin_roll * c, cos_roll * cos_pitch
    sector = AzimuthSector(
        fan.s_low[k], fan.s_high[k], fan.angle[k], fan.far_angle[k], fan.near_field[k] * height,
        math.sin(arrays.half_width), 2.0 * arrays.half_width, arrays.pattern.tabulated, grid.bent,
        cos_pitch, sin_pitch, side_x, side_z, up_x, up_z,
    )  # fmt: skip
    plane = HalfPlane(poses.x[ping], poses.y[ping], poses.z[ping], ex, ey)
    return plane, sector, grid.stretch * min(fan.reach[k] * height, arrays.bins * arrays.bin_length)
