"""Refusal of a sonar that is inside a target."""

import math
from collections.abc import Iterator

import numpy as np

from insonify.arrays import Floats
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.geometry.solids import find_enclosing_solid
from insonify.scene import SceneError

CLOSED = 0.99  # share of the whole sphere that a closed mesh covers from inside; an open one covers less


def refuse_sonar_in_target(arrays: SceneArrays, poses: Poses) -> None:
    """Raise if a ping is sent from inside a target."""
    target = next(_enclosing_targets(arrays, poses), None)
    if target is not None:
        raise SceneError(f"targets.{target}.position: the sonar runs into it; move the target or raise the track")


def _enclosing_targets(arrays: SceneArrays, poses: Poses) -> Iterator[int]:
    """Targets with a mesh or a solid that contains the sonar at some ping."""
    mesh, solids = arrays.mesh, arrays.solids
    if mesh.target.size > 0:
        places = np.column_stack([poses.x, poses.y, poses.z])
        places = _within(places, mesh.low[0], mesh.high[0])  # the box of the tree's root holds every triangle
        for target in np.unique(mesh.target) if len(places) else ():
            corners = mesh.corners[mesh.target == target]
            near = _within(places, corners.min(axis=(0, 1)), corners.max(axis=(0, 1)))
            if any(abs(solid_angle(corners - place)) > CLOSED * 4.0 * math.pi for place in near):
                yield int(target)
    if solids.shape.size > 0 and (solid := find_enclosing_solid(solids, poses.x, poses.y, poses.z)) >= 0:
        yield int(solids.target[solid])


def _within(places: Floats, low: Floats, high: Floats) -> Floats:
    """Places that lie inside a box."""
    return places[((places > low) & (places < high)).all(axis=1)]


def solid_angle(corners: Floats) -> float:
    """Signed solid angle of triangles as seen from the origin: ±4π within a closed shape, 0 outside."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    la, lb, lc = np.linalg.norm(corners, axis=2).T
    volume = (a * np.cross(b, c)).sum(axis=1)
    spread = la * lb * lc + (a * b).sum(axis=1) * lc + (a * c).sum(axis=1) * lb + (b * c).sum(axis=1) * la
    return float(2.0 * np.arctan2(volume, spread).sum())
