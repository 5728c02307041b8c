"""A scene packed for charts: traced in full, with nothing left out by a plan."""

from __future__ import annotations

import numpy as np

from insonify.kernels.common.types import Poses, SceneArrays, still_water
from insonify.packing.scene_arrays import pack_scene
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.scene import Scene
from insonify.simulation import prepare
from insonify.terrain import build_ground
from insonify.tow.poses import make_poses, take_poses


def pack_for_chart(scene: Scene, pings: int) -> tuple[SceneArrays, Poses]:
    """Arrays and poses of some pings of a scene, with refraction wherever the water has a gradient."""
    ground = build_ground(scene)
    arrays = pack_scene(scene, ground)
    # Only these effects are not simulated together with refraction, and only the plan tells which of both is kept.
    if arrays.water.bent and (arrays.multipath.enabled or arrays.bounces) and not prepare(scene).plan.bent:
        arrays = arrays._replace(water=still_water(arrays.water.reference, arrays.water.surface))
    poses = make_poses(scene, ground, np.unique(np.linspace(0, scene.track.pings - 1, pings).astype(np.int64)))
    tiles = TerrainTiles(ground, arrays.bins * arrays.bin_length).split(arrays, poses)
    places, arrays = max(tiles, key=lambda tile: poses.x[tile[0]].size)
    return arrays, take_poses(poses, places)
