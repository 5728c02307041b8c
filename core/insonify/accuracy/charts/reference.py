"""Reference of a chart: exact rays, doubled until their record changes by a tenth of the smallest error shown."""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from time import process_time
from typing import NamedTuple

import numpy as np

from insonify.arrays import Singles
from insonify.kernels.common.types import Poses, SceneArrays, no_surface_multipath
from insonify.parallel import count_threads
from insonify.statistics.record_errors import compare_records
from insonify.tow.poses import take_poses
from insonify.tracers import ray_sheets, rays

RESOLVED = 10.0  # ratio of an error to the change of the reference that resolves it
FIRST_RAYS = 1 << 16
MOST_IN_SHEETS, MOST_SINGLE = 1 << 24, 1 << 22  # rays per side
MEMORY = 1 << 30  # bytes of single rays of all cores together
SINGLE, BY_SURFACE = 128, 32  # bytes of a single ray, and of one by way of the sea surface
RAYS_A_SHEET = 16  # rays per sheet of a fan at which both parts of the error are about equal
# Order of the error in the number of rays, from which the next number is predicted.
SHEET_ORDER, RAY_ORDER = 1.0, 0.75


class Reference(NamedTuple):
    """Record by exact rays against which errors are computed."""

    record: Singles  # (n, 2, bins) record with the most rays
    # Change of the record by the last doubling of its rays, as a share of it beyond 1.4 times the altitude.
    moved: float
    rays: int  # number of rays per side
    moved_all: float = math.nan  # the same change over all bins from the first return; NaN where it is not known
    kind: str = "single rays"  # kind of the rays, in words

    @property
    def floor(self) -> float:
        """Smallest error that the reference resolves: ten times the change by the last doubling."""
        return RESOLVED * self.moved


def refine_reference(
    arrays: SceneArrays,
    poses: Poses,
    shown: Sequence[Singles],
    *,
    seconds: float,
    progress: Callable[[float], None] = lambda share: None,
) -> Reference:
    """Double the rays of a reference until its change is less than a tenth of the smallest error of some records."""
    began, count = process_time(), FIRST_RAYS
    order, most = (SHEET_ORDER, MOST_IN_SHEETS) if ray_sheets.can_trace(arrays) else (RAY_ORDER, MOST_SINGLE)

    def report() -> None:
        progress(min((process_time() - began) / seconds, 1.0))

    record = trace_exact_rays(arrays, poses, count, report)
    while True:
        start = process_time()
        finer = trace_exact_rays(arrays, poses, 2 * count, report)
        per_ray = (process_time() - start) / (2 * count)
        by = compare_records(arrays, poses, record, finer)
        moved = by.beyond
        smallest = min(compare_records(arrays, poses, other, finer).beyond for other in shown)
        left = seconds - (process_time() - began)
        # The change must become small enough; time and memory limit how often the number of rays is doubled. After
        # more than one doubling, a new pair of counts is traced.
        needed = max(math.log2(RESOLVED * moved / smallest) / order, 1.0) if moved > 0.0 < smallest else 64.0
        affordable = max(math.log2(left / per_ray / (3 * count)), 1.0) if left / per_ray >= 4 * count else 0.0
        doublings = min(math.ceil(needed), int(affordable), int(math.log2(most / (2 * count))))
        if moved * RESOLVED <= smallest or doublings < 1:
            return Reference(finer, moved, 2 * count, by.all_bins, name_rays(arrays))
        count <<= doublings
        record = finer if doublings == 1 else trace_exact_rays(arrays, poses, count, report)


def name_rays(arrays: SceneArrays) -> str:
    """Name the rays that `trace_exact_rays` traces a scene with."""
    if arrays.bounces:
        return "single rays"
    return "rays in sheets, surface paths by single rays" if arrays.multipath.enabled else "rays in sheets"


def trace_exact_rays(
    arrays: SceneArrays, poses: Poses, count: int, report: Callable[[], None] = lambda: None
) -> Singles:
    """Trace with a number of exact rays per side, pings in parallel."""
    # First echoes are traced in ray sheets, echoes by way of the sea surface ray by ray, and a scene with bounces ray
    # by ray altogether. ``report`` is called after every ping and may raise to stop.
    first = arrays._replace(multipath=no_surface_multipath())

    def single(pose: Poses) -> Singles:
        if arrays.bounces:
            return rays.trace(arrays, pose, rays=count, threads=1)
        # An even number: a beam with a pattern has half of its sheets in the main lobe.
        across = 2 * round(0.5 * math.sqrt(count / RAYS_A_SHEET)) if arrays.half_width > 0.0 else 1
        record = ray_sheets.trace(first, pose, sheets=across, rays=count // across, threads=1)
        return record + rays.trace_surface_paths(arrays, pose, rays=count, threads=1)

    records = []
    ray_bytes = SINGLE if arrays.bounces else BY_SURFACE if arrays.multipath.enabled else 1
    workers = min(count_threads(), max(MEMORY // (ray_bytes * count), 1))
    with ThreadPoolExecutor(workers) as pool:
        try:
            for record in pool.map(single, (take_poses(poses, slice(k, k + 1)) for k in range(poses.x.size))):
                records.append(record)
                report()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return np.concatenate(records)
