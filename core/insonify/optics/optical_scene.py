"""A scene packed for rays of light, with its sonar half way along the track."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from insonify.kernels.common.types import Poses, still_water
from insonify.packing.packed_scene import PackedScene, pack
from insonify.packing.scene_arrays import make_bed
from insonify.scene import Scene
from insonify.terrain import Ground


@dataclass(frozen=True, eq=False, kw_only=True)
class OpticalScene(PackedScene):
    """The bed around the sonar and the targets, packed for rays of light, which are straight."""

    ground: Ground
    pose: Poses  # the sonar half way along the track
    heading: float  # heading of the track there in radians


def make_optical_scene(scene: Scene) -> OpticalScene:
    """Build and pack a scene for rays of light."""
    packed = pack(scene)
    middle = np.array([scene.track.pings // 2], dtype=np.int64)
    pose, arrays = packed.poses(middle), packed.arrays
    reach = arrays.bins * arrays.bin_length
    ground = packed.ground.around((float(pose.x[0]), float(pose.y[0])), 1.5 * reach)  # to the corners of the cutaway
    straight = arrays._replace(bed=make_bed(ground), water=still_water())
    heading = float(packed.line(middle).heading[0])
    return OpticalScene(scene=scene, ground=ground, arrays=straight, pose=pose, heading=heading)
