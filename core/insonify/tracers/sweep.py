"""The sweep: a few vertical planes cut the scene, and one running horizon in each decides which bed is visible.

Through layered water it goes by tables of apparent positions; pings without valid tables are traced by sheets of rays.
Derived in docs/theory/sweep.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.common.contributors import empty_contributor_table
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.multipath.surface_multipath import empty_multipath_workspace, sweep_multipath
from insonify.kernels.refraction.apparent_positions import ApparentTables
from insonify.kernels.sweep.sweep import AzimuthFan, empty_sweep_workspace, sweep_pings
from insonify.packing.apparent_tables import make_apparent_tables
from insonify.parallel import PerThread
from insonify.tow.poses import take_poses
from insonify.tracers import ray_sheets
from insonify.tracers.azimuth_fan import lay_planes_of_images
from insonify.tracers.base import Record, new_record, trace_blocks
from insonify.tracers.rays import trace as trace_rays

RAYS_A_SHEET = 8.0  # of a fan where refraction folds, per root of all its rays: both parts of the error are about equal
PLANES_A_THREAD = 64  # planes of both sides worth handing to a thread, some 0.4 ms


def trace(
    arrays: SceneArrays,
    poses: Poses,
    *,
    planes: int = 16,
    rays: int = 4000,
    threads: int | None = None,
    double: bool = False,
) -> Record:
    """Trace pings by the sweep."""
    apparent, folded = make_apparent_tables(arrays, poses)
    out = new_record(arrays, poses)
    if folded.any():
        out[folded] = _trace_folded(arrays, take_poses(poses, np.flatnonzero(folded)), rays, threads)
    clear = np.flatnonzero(~folded)
    for among, beam, lifted in lay_planes_of_images(arrays, take_poses(poses, clear), planes):
        places = clear[among]
        some = take_poses(poses, places)
        traced = out if places.size == poses.x.size else new_record(arrays, some)
        _trace_alike(arrays, some, (beam, lifted), apparent, double, threads, traced)
        if traced is not out:
            out[places] = traced
    return out


def _trace_folded(arrays: SceneArrays, poses: Poses, rays: int, threads: int | None) -> Record:
    """Trace pings from which places are reached by several rays or by none, in sheets of rays where those serve."""
    if not ray_sheets.can_trace(arrays):
        return trace_rays(arrays, poses, rays=rays, threads=threads)
    sheets = max(round(math.sqrt(rays) / RAYS_A_SHEET), 1) if arrays.half_width > 0.0 else 1
    return ray_sheets.trace(arrays, poses, sheets=sheets, rays=max(rays // sheets, sheets), threads=threads)


def _trace_alike(
    arrays: SceneArrays,
    poses: Poses,
    beams: tuple[AzimuthFan, AzimuthFan],
    apparent: ApparentTables,
    double: bool,
    threads: int | None,
    out: Record,
) -> None:
    """Trace pings that share their planes, those of the sonar and those of its image in the sea surface."""
    real = np.float64 if double else np.float32
    beam, lifted = beams
    rooms = PerThread(lambda: empty_sweep_workspace(arrays, apparent, real))

    def block(part: Poses, first: int, last: int) -> int:
        room = rooms.own
        status = sweep_pings(arrays, part, beam, apparent, room, out[first:last])
        if arrays.multipath.enabled and status == 0:
            images = empty_multipath_workspace(arrays, real)
            sweep_multipath(arrays, part, beam, lifted, images, empty_contributor_table(0, 0), out[first:last])
        return int(status)

    trace_blocks(arrays, poses, block, threads, pings_a_thread(beam))


def pings_a_thread(beam: AzimuthFan) -> int:
    """Return the number of pings worth handing to a thread."""
    # A squinting beam over a bed out of reach has no planes.
    return max(PLANES_A_THREAD // max(beam.azimuth.size, 1), 1)
