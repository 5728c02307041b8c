"""The reference of a chart: exact rays, doubled until that moves them less than a tenth of the smallest error shown."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from time import process_time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy.record_errors import compare_records
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.navigation import take_poses
from insonify.tracers import ray_sheets, rays

RESOLVED = 10.0  # times finer than an error the reference is to be
FIRST_RAYS = 1 << 16
MOST_IN_SHEETS, MOST_TOGETHER = 1 << 24, 1 << 20  # rays one by one are held in memory together, by every core
RAYS_A_SHEET = 16  # for every sheet of a fan; with as many both halves of the error are alike
# Of the error, by which more rays are foreseen.
SHEET_ORDER, RAY_ORDER = 1.0, 0.75

Record = NDArray[np.float32]


class Reference(NamedTuple):
    """What is taken as right.

    Attributes
    ----------
    record : (n, 2, bins) float32
        The finest record.
    moved : float
        How far the last doubling of its rays moved it, as a share of the record beyond 1.4 times the altitude.
    rays : int
        Rays per side.
    moved_all : float
        Likewise over all bins from the first return; NaN where it is not known.
    """

    record: Record
    moved: float
    rays: int
    moved_all: float = math.nan

    @property
    def floor(self) -> float:
        """Error below which a record cannot be told from the reference: ten times what the last doubling moved."""
        return RESOLVED * self.moved


def refine_reference(
    arrays: SceneArrays,
    poses: Poses,
    shown: Sequence[Record],
    *,
    seconds: float,
    progress: Callable[[float], None] = lambda share: None,
) -> Reference:
    """Double rays until that moves their record by less than a tenth of the smallest error of some others.

    Parameters
    ----------
    arrays : SceneArrays
        The scene as kernels see it.
    poses : Poses
        Where the sonar is, n pings.
    shown : sequence of (n, 2, bins) float32
        Records whose errors are to be resolved.
    seconds : float
        Processor time that it may take, of all cores together; the last doubling that fits is the last.
    progress : callable
        Called with the share done; may raise to stop.

    Returns
    -------
    Reference
    """
    began, count = process_time(), FIRST_RAYS
    order = SHEET_ORDER if ray_sheets.can_trace(arrays) else RAY_ORDER
    most = MOST_IN_SHEETS if ray_sheets.can_trace(arrays) else MOST_TOGETHER

    def told() -> None:
        progress(min((process_time() - began) / seconds, 1.0))

    record = trace_exact_rays(arrays, poses, count, told)
    while True:
        start = process_time()
        finer = trace_exact_rays(arrays, poses, 2 * count, told)
        per_ray = (process_time() - start) / (2 * count)
        by = compare_records(arrays, poses, record, finer)
        moved = by.beyond
        smallest = min(compare_records(arrays, poses, other, finer).beyond for other in shown)
        left = seconds - (process_time() - began)
        doublings = _doublings(RESOLVED * moved / smallest if smallest > 0.0 else math.inf, order)
        doublings = min(doublings, _affordable(left / per_ray, count), int(math.log2(most / (2 * count))))
        if moved * RESOLVED <= smallest or doublings < 1:
            return Reference(finer, moved, 2 * count, by.all_bins)
        count <<= doublings
        record = finer if doublings == 1 else trace_exact_rays(arrays, poses, count, told)


def trace_exact_rays(arrays: SceneArrays, poses: Poses, count: int, told: Callable[[], None] = lambda: None) -> Record:
    """Trace with so many exact rays a side, in sheets where these do, each ping on whatever core is free.

    After every ping ``told`` is called, which may raise to stop.
    """

    def single(pose: Poses) -> Record:
        if not ray_sheets.can_trace(arrays):
            return rays.trace(arrays, pose, rays=count, threads=1)
        # In pairs: half the places within a beam with a pattern are for its main lobe.
        across = 2 * round(0.5 * math.sqrt(count / RAYS_A_SHEET)) if arrays.half_width > 0.0 else 1
        return ray_sheets.trace(arrays, pose, sheets=across, rays=count // across, threads=1)

    records = []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        try:
            for record in pool.map(single, (take_poses(poses, slice(k, k + 1)) for k in range(poses.x.size))):
                records.append(record)
                told()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return np.concatenate(records)


def _doublings(factor: float, order: float) -> int:
    """Doublings that divide what the last one moved by a factor."""
    return max(math.ceil(math.log2(max(factor, 1.0)) / order), 1) if math.isfinite(factor) else 64


def _affordable(rays_left: float, count: int) -> int:
    """Doublings of a count for which there are rays left: one more is twice its last, several begin with a pair."""
    if rays_left < 4 * count:
        return 0
    return max(1, math.floor(math.log2(rays_left / (3 * count))))
