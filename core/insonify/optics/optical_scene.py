"""A scene packed for rays of light, with its sonar half way along the track."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from insonify.kernels.common.types import Poses, SceneArrays, still_water
from insonify.packing.scene_arrays import make_bed, pack_scene
from insonify.scene import Scene
from insonify.terrain import Ground, build_ground
from insonify.tow.line import tow_line_at
from insonify.tow.poses import make_poses


@dataclass(frozen=True, eq=False)
class OpticalScene:
    """A scene packed for rays of light."""

    scene: Scene  # its declaration
    ground: Ground  # the bed around the sonar
    arrays: SceneArrays  # packed scene in water without refraction: rays of light are straight
    pose: Poses  # the sonar half way along the track
    heading: float  # heading of the track there in radians


def make_optical_scene(scene: Scene) -> OpticalScene:
    """Build and pack a scene for rays of light."""
    everywhere = build_ground(scene)
    arrays = pack_scene(scene, everywhere)
    middle = np.array([scene.track.pings // 2], dtype=np.int64)
    pose = make_poses(scene, everywhere, middle)
    reach = arrays.bins * arrays.bin_length
    ground = everywhere.around((float(pose.x[0]), float(pose.y[0])), 1.5 * reach)  # to the corners of the cutaway
    straight = arrays._replace(bed=make_bed(ground), water=still_water())
    return OpticalScene(scene, ground, straight, pose, float(tow_line_at(scene, middle).heading[0]))
