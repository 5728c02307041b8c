"""The sweep: a few vertical planes cut the scene, and one running horizon in each decides which bed is visible.

Through layered water it goes by tables of apparent positions; pings without valid tables are traced by sheets of rays.
Derived in docs/theory/sweep.md.
"""

import math
from typing import Any

import numpy as np

from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.contributors import empty_contributor_table
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.multipath.surface_multipath import empty_multipath_workspace, sweep_multipath
from insonify.kernels.sweep.bed_stretches import FINE
from insonify.kernels.sweep.plane_errors import empty_plane_sums
from insonify.kernels.sweep.sweep import LaidPlanes, empty_sweep_workspace, sweep_pings
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.packing.containment import refuse_sonar_in_target
from insonify.packing.packed_scene import SURFACE_ECHO, Model
from insonify.parallel import PerThread
from insonify.scene import Scene
from insonify.tow.poses import take_poses
from insonify.tracers import ray_sheets
from insonify.tracers.azimuth_fan import beam_planes, lay_planes_of_images
from insonify.tracers.base import PreparedTracer, Tracer, new_record, share_blocks
from insonify.tracers.plane_counts import (
    AS_ESTIMATED,
    Columns,
    Goal,
    TracedPings,
    Trust,
    empty_bin_errors,
    empty_squares,
    more_across,
    trace_until,
)
from insonify.tracers.rays import trace as trace_rays
from insonify.tracers.scatterers import make_tracer
from insonify.tracers.target_planes import count_added_planes

RAYS_A_SHEET = 8.0  # of a fan where refraction folds, per root of all its rays: both parts of the error are about equal
PLANES_A_THREAD = 64  # planes of both sides worth handing to a thread, some 0.4 ms

SINGLE = 1e-6  # greatest relative error of 32-bit numbers with 64-bit sums, ten roundings of 2⁻²⁴ each

# Work of a ping in knots of one plane over uniform water: of a plane besides its knots, of a target in a plane, and the
# factor of refraction.
PLANE, TARGET, REFRACTED = 300.0, 100.0, 1.5
# Of a path by a calm sea over that of the direct one, and what each facet of a rough sea adds.
SURFACE_PATH, FACET = 1.0, 0.25
# Of a segment too long against its range for one density, taken by itself, and of each of its parts.
CUT_SEGMENT, PART = 7.0, 2.5
NEAR_PLANES, NEAR_PLANES_OF_PATTERN = 4.0, 12.0  # planes of the near field that several planes need
DIVIDED = 20_000.0  # of one side of a ping that has planes of its own
# Work of a profile with segments divided until they misplace a share of a bin's echo, over that of a whole one.
KNOTS = {math.inf: 1.0, 0.03: 2.5, 0.01: 3.0, 0.003: 4.5}


class Sweep(Tracer):
    """The sweep; for coherent speckle, a tracer of scatterers that are visible to it."""

    name, rank, automatic = "sweep", 0, True
    fineness = ("planes", "across", "rays", "misplaced", "every")
    sums_waves, refracts_along = True, False
    refraction, rounding = "tables of apparent positions", SINGLE

    def prepare(self, scene: Scene, arrays: SceneArrays) -> PreparedTracer:
        """Return the tracer of scatterers for coherent speckle."""
        return make_tracer(scene, arrays) if scene.receiver.speckle.interferes else self

    def settings(self, model: Model) -> dict[str, Any]:
        """Planes, those across targets, and with refraction the rays of pings that are traced ray by ray."""
        across = {"across": model.across} if model.across > 0 else {}
        return {"planes": model.planes} | across | ({"rays": model.rays} if model.bent else {})

    def work(self, scene: Scene, arrays: SceneArrays, model: Model) -> float:
        """Knots of all planes, of the direct path and of those by the sea surface."""
        heading = math.radians(scene.track.heading)
        across = abs(math.cos(heading)) + abs(math.sin(heading))  # a plane crosses both families of grid lines
        spacing = arrays.bed.spacing * model.every / across
        segments, parts, beyond = _divide_profile(arrays.bins * arrays.bin_length, spacing, scene.altitude)
        knots = (CUT_SEGMENT * segments + PART * parts + beyond) * KNOTS[model.misplaced]
        profile = PLANE + knots * (REFRACTED if model.bent else 1.0) + TARGET * len(model.targets)
        near = NEAR_PLANES_OF_PATTERN if arrays.pattern.tabulated else NEAR_PLANES
        planes = 1.0 if model.planes == 1 else model.planes + near
        if model.across > 0 and model.targets:
            fan = beam_planes(arrays.half_width, max(model.planes, 2))
            added, divided = count_added_planes(scene, arrays, model.across, fan)
            planes += added + divided * DIVIDED / profile
        facets = arrays.multipath.facets.shape[1]
        path = SURFACE_PATH + (FACET * facets if facets > 1 else 0.0)
        return 2.0 * planes * profile * (1.0 + path * len(model.ways - {SURFACE_ECHO}))

    def trace(self, arrays: SceneArrays, poses: Poses, **settings: Any) -> Singles:
        """Trace pings by the settings of this method."""
        return trace(arrays, poses, **settings)


def _divide_profile(reach: float, spacing: float, height: float) -> tuple[float, float, float]:
    """Numbers of segments of a profile too long for one density of echo, of their parts, and of other segments."""
    height = max(height, spacing)
    nearer = min(math.sqrt(max((spacing / FINE) ** 2 - height**2, 0.0)), reach)
    segments = nearer / spacing
    return segments, math.asinh(nearer / height) / FINE + 0.5 * segments, (reach - nearer) / spacing


def trace_measured(
    arrays: SceneArrays,
    poses: Poses,
    *,
    planes: int = 16,
    across: int = 0,
    goal: Goal | None = None,
    of_bins: bool = False,
    **settings: Any,
) -> TracedPings:
    """Trace pings by the sweep, each by as many planes as its error requires; find the error of bins if wanted."""

    def trace_some(places: Integers, counts: Integers) -> Columns:
        squares, more = empty_squares(places.size), more_across(counts, planes, across)
        some, bins = take_poses(poses, places), empty_bin_errors(places.size, arrays.bins if of_bins else 0)
        measured: dict[str, Any] = {"squares": squares, "bin_errors": bins}
        measured |= {} if goal is None else {"trust": goal.trust}
        return trace(arrays, some, planes=counts, across=more, **measured, **settings), bins, squares

    (echoes, bins, squares), counts = trace_until(goal, planes, poses.x.size, trace_some)
    return TracedPings(echoes, squares, counts, bins)


def trace(
    arrays: SceneArrays,
    poses: Poses,
    *,
    planes: int | Integers = 16,
    across: int | Integers = 0,
    rays: int = 4000,
    threads: int | None = None,
    double: bool = False,
    squares: Floats | None = None,
    bin_errors: Singles | None = None,
    trust: Trust = AS_ESTIMATED,
) -> Singles:
    """Trace pings by the sweep, all by the same number of planes or each by its own.

    ``squares`` takes the squares of the errors of planes, where they are measured, ``bin_errors`` the errors of bins by
    planes, as intensities; both as far as what planes estimate is trusted.
    """
    refuse_sonar_in_target(arrays, poses)
    apparent, folded = make_apparent_tables(arrays, poses)
    out = new_record(arrays, poses)
    if folded.any():
        out[folded] = _trace_folded(arrays, take_poses(poses, np.flatnonzero(folded)), rays, threads)
    clear = np.flatnonzero(~folded)
    some, whole = take_poses(poses, clear), clear.size == poses.x.size
    counts = (np.broadcast_to(np.asarray(number, np.int64), poses.x.shape)[clear] for number in (planes, across))
    laid, image_laid = lay_planes_of_images(arrays, some, *counts)
    width = 0 if bin_errors is None else bin_errors.shape[-1]
    found = (
        out if whole else new_record(arrays, some),
        empty_squares(0 if squares is None else clear.size),
        empty_bin_errors(clear.size, width),
    )
    dtype = np.float64 if double else np.float32
    rooms = PerThread(
        lambda: (
            empty_sweep_workspace(arrays, apparent, dtype),
            empty_multipath_workspace(arrays, dtype) if arrays.multipath.enabled else None,
            empty_plane_sums(arrays.bins),
        )
    )

    def sweep(part: Poses, first: int, last: int) -> None:
        (room, images, sums), own = rooms.own, laid.of_pings(slice(first, last))
        to = tuple(array[first:last] for array in found)
        sweep_pings(arrays, part, own, apparent, room, sums, *to)
        if images is not None:
            table, of_images = empty_contributor_table(0, 0, 1, 0), image_laid.of_pings(slice(first, last))
            sweep_multipath(arrays, part, own, of_images, images, table, sums, *to)

    share_blocks(some, sweep, threads, pings_a_thread(laid))
    if not whole:
        out[clear] = found[0]
    if squares is not None:
        own = trust.of(arrays, some, laid)[:, None, None]
        squares[clear] = found[1]
        squares[clear, :, :, 0] *= own * own
        if bin_errors is not None:
            bin_errors[clear] = found[2] * own
    return out


def _trace_folded(arrays: SceneArrays, poses: Poses, rays: int, threads: int | None) -> Singles:
    """Trace pings from which places are reached by several rays or by none: by sheets of rays where those serve."""
    if not ray_sheets.can_trace(arrays):
        return trace_rays(arrays, poses, rays=rays, threads=threads)
    sheets = max(round(math.sqrt(rays) / RAYS_A_SHEET), 1) if arrays.half_width > 0.0 else 1
    return ray_sheets.trace(arrays, poses, sheets=sheets, rays=max(rays // sheets, sheets), threads=threads)


def pings_a_thread(laid: LaidPlanes) -> int:
    """Return the number of pings worth handing to a thread."""
    # A squinting beam over a bed out of reach has no planes.
    planes = int((laid.last - laid.first).max(initial=1))
    return max(PLANES_A_THREAD // planes, 1)
