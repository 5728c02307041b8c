"""What a light picture is of: a scene laid out, and where its sonar is half way along the tow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from insonify.kernels.common.types import Poses, SceneArrays, still_water
from insonify.packing.navigation import make_poses
from insonify.packing.scene_arrays import make_bed, pack_scene
from insonify.packing.track import tow_line_at
from insonify.scene import Scene
from insonify.terrain import Ground, build_ground


@dataclass(frozen=True, eq=False)
class Setting:
    """A scene as light finds it.

    Attributes
    ----------
    scene : Scene
        What was declared.
    ground : Ground
        The bed about the sonar.
    problem : Problem
        All of it as kernels see it, in water in which nothing bends, as light goes.
    pose : Poses
        The sonar half way along the tow.
    heading : float
        That of its line, in radians.
    """

    scene: Scene
    ground: Ground
    arrays: SceneArrays
    pose: Poses
    heading: float


def make_setting(scene: Scene) -> Setting:
    """Lay a scene out.

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy.
    """
    everywhere = build_ground(scene)
    arrays = pack_scene(scene, everywhere)
    middle = np.array([scene.track.pings // 2], dtype=np.int64)
    pose = make_poses(scene, everywhere, middle)
    reach = arrays.bins * arrays.bin_length
    ground = everywhere.around((float(pose.x[0]), float(pose.y[0])), 1.5 * reach)  # to the block's corners
    straight = arrays._replace(bed=make_bed(ground), water=still_water())
    return Setting(scene, ground, straight, pose, float(tow_line_at(scene, middle).heading[0]))
