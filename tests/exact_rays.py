"""Records by exact rays, refined until they are good enough to judge others, and orders of convergence."""

import math
from collections.abc import Callable

import numpy as np

from insonify.kernels.common.types import Poses, SceneArrays
from insonify.statistics.record_errors import compare_records
from insonify.tracers import rays

Trace = Callable[[SceneArrays, Poses, int], np.ndarray]


def reference(
    arrays: SceneArrays,
    poses: Poses,
    *,
    tolerance: float,
    trace: Trace = lambda arrays, poses, count: rays.trace(arrays, poses, rays=count),
    first: int = 1 << 15,
    most: int = 1 << 22,
    times: int = 2,
) -> tuple[np.ndarray, float]:
    """Trace with more rays until that moves the record by less than a tolerance; the record and its move."""
    count, moved = first, math.inf
    record = trace(arrays, poses, count)
    while moved >= tolerance and count < most:
        count *= times
        finer = trace(arrays, poses, count)
        moved, record = compare_records(arrays, poses, record, finer).beyond, finer
    return record, moved


def order(counts: np.ndarray, errors: list[float]) -> float:
    """Order at which errors fall with counts."""
    return float(-np.polyfit(np.log(counts), np.log(errors), 1)[0])
