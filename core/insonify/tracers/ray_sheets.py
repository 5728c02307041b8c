"""Sheets of rays: the reference of the charts, more accurate than as many single rays."""

from insonify.arrays import Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.rays.ray_sheets import trace_ray_sheets
from insonify.scene import SceneError
from insonify.tracers.base import trace_blocks


def trace(
    arrays: SceneArrays, poses: Poses, *, sheets: int = 64, rays: int = 1024, threads: int | None = None
) -> Singles:
    """Trace pings by exact rays, sheet by sheet, each sheet integrated over elevation."""
    sheets = int(sheets) if arrays.half_width > 0.0 else 1
    if not 1 <= sheets <= rays:
        raise SceneError(f"rays: {rays} rays for {sheets} sheets are too few; give at least one per sheet")
    if not can_trace(arrays):
        raise SceneError("sheets: this method traces first echoes only; use rays for multipath and bounces")
    return trace_blocks(
        arrays, poses, lambda part, out: trace_ray_sheets(arrays, part, sheets, int(rays), out), threads
    )


def can_trace(arrays: SceneArrays) -> bool:
    """Whether a scene has first echoes alone."""
    return not (arrays.multipath.enabled or arrays.bounces)
