"""The march: rays in steps of fixed length, the classical method with which the other methods are compared."""

import math
from typing import Any

from insonify.arrays import Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.packed_scene import Model
from insonify.scene import SceneError
from insonify.tracers.rays import Rays, trace_rays

STEP = 0.6  # work of a step, in knots of the sweep


class March(Rays):
    """Rays in steps of fixed length."""

    name, rank, automatic = "march", 1, False
    fineness, ladder = ("step", "rays"), None
    follows_bounces = False

    def settings(self, model: Model) -> dict[str, Any]:
        """Length of a step, and rays per side."""
        return {"step": model.step, "rays": model.rays}

    def work_of_ray(self, arrays: SceneArrays, model: Model) -> float:
        """Work of a ray and of its steps over the range."""
        return super().work_of_ray(arrays, model) + STEP * (arrays.bins * arrays.bin_length) / model.step

    def trace(self, arrays: SceneArrays, poses: Poses, **settings: Any) -> Singles:
        """Trace pings by the settings of this method."""
        return trace(arrays, poses, **settings)


def trace(
    arrays: SceneArrays, poses: Poses, *, step: float = 0.1, rays: int = 1000, threads: int | None = None
) -> Singles:
    """Trace pings by marching along each ray until it is below the bed or inside a body."""
    if not (step > 0.0 and math.isfinite(step)):
        raise SceneError(f"step: {step:g} m is not valid; give a length above 0")
    return trace_rays(arrays, poses, rays, step, threads)
