"""Reduced scene: the arrays of a scene without the effects and targets that the plan omits."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Bed, SceneArrays, Solids
from insonify.kernels.geometry.bvh import build_mesh
from insonify.scene.water.surfaces import WAYS


def reduce_scene(
    arrays: SceneArrays, *, bed: Bed, ways: Collection[str], bounces: int, targets: Collection[int]
) -> SceneArrays:
    """Remove from a scene's arrays the targets, paths and bounces that the plan omits."""
    multipath = arrays.multipath
    heard: dict[str, Any] = {way: getattr(multipath, way) and way in ways for way in WAYS}
    arrays = arrays._replace(
        multipath=multipath._replace(enabled=any(heard.values()), **heard), bounces=bounces, bed=bed
    )
    kept = np.asarray(sorted(targets), dtype=np.int64)
    return _without_others(arrays, np.isin(arrays.solids.target, kept), np.isin(arrays.mesh.target, kept))


def without_targets(arrays: SceneArrays) -> SceneArrays:
    """Return a scene's arrays without its targets."""
    none: NDArray[np.bool_] = np.zeros(arrays.solids.target.size, np.bool_)
    return _without_others(arrays, none, np.zeros(arrays.mesh.target.size, np.bool_))


def _without_others(arrays: SceneArrays, solids: NDArray[np.bool_], triangles: NDArray[np.bool_]) -> SceneArrays:
    """Scene with only some of its solids and triangles."""
    if solids.all() and triangles.all():
        return arrays
    mesh = arrays.mesh
    columns: list[Any] = [column[solids] for column in arrays.solids]
    return arrays._replace(
        solids=Solids(*columns),
        mesh=build_mesh(mesh.corners[triangles], mesh.material[triangles], mesh.target[triangles]),
    )
