"""The reference of a chart: rays, doubled until that moves them less than a tenth of the smallest error shown."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy import compare
from insonify.kernels.types import Poses, Problem
from insonify.tracers import rays
from insonify.tracers.poses import take

RESOLVED = 10.0  # times finer than an error the reference is to be
FIRST_RAYS = 1 << 16
MOST_RAYS = 1 << 24
KNIFE_ORDER, FAN_ORDER = 1.0, 0.75  # of the error of rays, by which more of them are foreseen

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
    """

    record: Record
    moved: float
    rays: int

    @property
    def floor(self) -> float:
        """Error below which a record cannot be told from the reference: ten times what the last doubling moved."""
        return RESOLVED * self.moved


def prove(
    problem: Problem,
    poses: Poses,
    shown: Sequence[Record],
    *,
    seconds: float,
    progress: Callable[[float], None] = lambda share: None,
) -> Reference:
    """Double rays until that moves their record by less than a tenth of the smallest error of some others.

    Parameters
    ----------
    problem : Problem
        The scene as kernels see it.
    poses : Poses
        Where the sonar is, n pings.
    shown : sequence of (n, 2, bins) float32
        Records whose errors are to be resolved.
    seconds : float
        Time that it may take, about; the last doubling that fits is the last.
    progress : callable
        Called with the share done; may raise to stop.

    Returns
    -------
    Reference
    """
    began, count = perf_counter(), FIRST_RAYS
    order = FAN_ORDER if problem.half_width > 0.0 else KNIFE_ORDER
    record = trace(problem, poses, count)
    while True:
        progress(min((perf_counter() - began) / seconds, 1.0))
        start = perf_counter()
        finer = trace(problem, poses, 2 * count)
        per_ray = (perf_counter() - start) / (2 * count)
        moved = compare(problem, poses, record, finer).beyond
        smallest = min(compare(problem, poses, other, finer).beyond for other in shown)
        left = seconds - (perf_counter() - began)
        doublings = _doublings(RESOLVED * moved / smallest if smallest > 0.0 else math.inf, order)
        # A pair costs three times its first half, a doubling of the finest record but its own rays.
        doublings = min(doublings, _affordable(left / per_ray, count), int(math.log2(MOST_RAYS / (2 * count))))
        if moved * RESOLVED <= smallest or doublings < 1:
            return Reference(finer, moved, 2 * count)
        count <<= doublings
        record = finer if doublings == 1 else trace(problem, poses, count)


def trace(problem: Problem, poses: Poses, count: int) -> Record:
    """Trace ray by ray, each ping on whatever core is free."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        singles = [take(poses, slice(k, k + 1)) for k in range(poses.x.size)]
        return np.concatenate(list(pool.map(lambda pose: rays.trace(problem, pose, rays=count, threads=1), singles)))


def _doublings(factor: float, order: float) -> int:
    """Doublings that divide what the last one moved by a factor."""
    return max(math.ceil(math.log2(max(factor, 1.0)) / order), 1) if math.isfinite(factor) else 64


def _affordable(rays_left: float, count: int) -> int:
    """Doublings of a count for which there are enough rays left."""
    if rays_left < 4 * count:
        return 0
    return max(1, math.floor(math.log2(rays_left / (3 * count))))
