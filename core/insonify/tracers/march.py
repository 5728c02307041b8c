"""The march: rays in steps of fixed length, the classical method with which the other methods are compared."""

from __future__ import annotations

import math

from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import SceneError
from insonify.tracers.base import Record
from insonify.tracers.rays import trace_rays


def trace(
    arrays: SceneArrays, poses: Poses, *, step: float = 0.1, rays: int = 1000, threads: int | None = None
) -> Record:
    """Trace pings by marching along each ray until it is below the bed or inside a body."""
    if not (step > 0.0 and math.isfinite(step)):
        raise SceneError(f"step: {step:g} is no length; give metres greater than 0")
    return trace_rays(arrays, poses, rays, step, threads)
