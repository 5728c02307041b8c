"""Small scenes for cases: a level bed or a bed of given heights, and one ping over it."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from insonify.arrays import Floats
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.scene_arrays import make_bed
from insonify.scene import Scene, SceneError, edit
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.simulation import prepare
from insonify.terrain import Ground
from insonify.tracers import sweep

LEVEL: dict[str, Any] = {
    "seabed.material": {"name": "medium_sand", "diffuse": 1.0, "specular": 0.0},
    "sonar.beam": "knife",
    "sonar.pulse": "ideal",
    "track.altitude": 10.0,
    "track.pings": 1,
}


def make_level_scene(changes: Mapping[str, Any] | None = None) -> Scene:
    """Make a scene of a level Lambert bed, one ping of a knife-edge beam with an ideal pulse, and change it."""
    return edit(Scene(), LEVEL | dict(changes or {}))


def level_arrays(changes: Mapping[str, Any] | None = None) -> SceneArrays:
    """Arrays of such a scene."""
    return prepare(make_level_scene(changes)).arrays


def first_ping(scene: Scene) -> tuple[SceneArrays, Poses]:
    """Arrays of a scene and the pose of its first ping."""
    simulation = prepare(scene)
    return simulation.arrays, simulation.poses(np.zeros(1, dtype=np.int64))


def arrays_over(
    heights: ArrayLike, spacing: float, changes: Mapping[str, Any] | None = None, **place: float
) -> SceneArrays:
    """Arrays of such a scene over a bed of given heights that ends at its outermost nodes."""
    return level_arrays(changes)._replace(bed=make_bed(make_ground(heights, spacing, **place)))


def make_ground(heights: ArrayLike, spacing: float, *, x0: float = 0.0, y0: float = 0.0) -> Ground:
    """Make a ground of given heights, rows along y."""
    z = np.asarray(heights, dtype=np.float32)
    materials = np.zeros(z.shape, dtype=np.uint8)
    return Ground(z, materials, ("bed",), (Reflectivity(1.0, 0.0, 1.0),), x0, y0, spacing, periodic=False, datum=0.0)


def make_pose(x: float, y: float, z: float, heading: float = 0.0) -> Poses:
    """Place a level sonar; z above the datum, heading in radians."""
    return Poses(*(np.array([value]) for value in (x, y, z, heading, 0.0, 0.0)))


def sweep_port(arrays: SceneArrays, pose: Poses, **options: Any) -> Floats:
    """Record of the port side of one ping by the sweep, (bins,)."""
    return sweep.trace(arrays, pose, **options)[0, 0].astype(np.float64)


def ball_at(x: float, y: float, z: float, radius: float, **fields: Any) -> dict[str, Any]:
    """Declare a sphere by its centre."""
    return {"kind": "sphere", "position": [x, y, z], "radius": radius, **fields}


def error_message(make: Callable[[], object]) -> str:
    """Message of the error that a scene raises; empty without an error."""
    try:
        make()
    except SceneError as error:
        return str(error)
    return ""
