"""The march: rays in steps of fixed length, the classical method with which the other methods are compared."""

from __future__ import annotations

import math

from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import SceneError
from insonify.tracers.blocks import Record
from insonify.tracers.rays import trace_rays


def trace(
    arrays: SceneArrays, poses: Poses, *, step: float = 0.1, rays: int = 1000, threads: int | None = None
) -> Record:
    """Trace pings by marching along each ray until it is below the bed or inside a body.

    Parameters
    ----------
    arrays : SceneArrays
        The packed scene.
    poses : Poses
        Poses of the sonar, n pings.
    step : float
        Length of a step in metres; what is thinner can be stepped over.
    rays : int
        Rays per side and ping.
    threads : int, optional
        Threads to use, all cores when left out. The result does not depend on it.

    Returns
    -------
    (n, 2, bins) float32
        Intensity of the two channels, port first.

    Raises
    ------
    SceneError
        If the step is not positive, there are no rays, or the sonar runs into a target.
    """
    if not (step > 0.0 and math.isfinite(step)):
        raise SceneError(f"step: {step:g} is no length; give metres greater than 0")
    return trace_rays(arrays, poses, rays, step, threads)
