"""Pings shared among threads in blocks, each traced by a kernel whose status reports a sonar inside a target."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.containment import refuse_sonar_in_mesh, refuse_sonar_in_solid
from insonify.parallel import in_parallel
from insonify.tow.poses import take_poses

Record = NDArray[np.float32]


def trace_blocks(
    arrays: SceneArrays, poses: Poses, trace: Callable[[Poses, int, int], int], threads: int | None, least: int = 1
) -> None:
    """Trace pings block by block, on several threads."""

    def block(first: int, last: int) -> int:
        return int(trace(take_poses(poses, slice(first, last)), first, last))

    refuse_sonar_in_mesh(arrays, poses)
    refuse_sonar_in_solid(arrays.solids, in_parallel(block, poses.x.size, threads, least))


def empty_record(arrays: SceneArrays, poses: Poses) -> Record:
    """Record of zeros, (pings, 2, bins)."""
    return np.zeros((poses.x.size, 2, arrays.bins), dtype=np.float32)


def new_record(arrays: SceneArrays, poses: Poses) -> Record:
    """Record without values, (pings, 2, bins), for a tracer that sets every bin."""
    return np.empty((poses.x.size, 2, arrays.bins), dtype=np.float32)
