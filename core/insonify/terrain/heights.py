"""Heights of a seabed as arrays and as a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.scene import Scene, SceneError
from insonify.scene.seabed import Seabed
from insonify.scene.seabed.reliefs.spectrum import Field
from insonify.terrain.build import FLAT_CELLS, build_ground, cells_of_period, sample_heights
from insonify.terrain.endless_field import Nodes, gather_tiles
from insonify.terrain.endless_ground import EndlessGround
from insonify.terrain.endless_relief import endless_heights
from insonify.terrain.periodic_relief import periodic_heights

SHOWN = 1024  # nodes along a side of the picture of endless ground


def relief(seabed: Seabed, shape: tuple[int, int] | None = None, *, seed: int = 1) -> Field:
    """Heights of a seabed above its mean."""
    if shape is not None and min(shape) < 1:
        raise SceneError(f"shape: {shape} has no nodes; give at least (1, 1)")
    if seabed.endless:
        made = endless_heights(seabed.random_reliefs, seabed.spacing, seed)
        # Tile by tile: whatever is asked for, it takes little memory.
        return gather_tiles(lambda *place: made(Nodes.of_tile(*place)), (0, 0), shape or (SHOWN, SHOWN))
    if seabed.random_reliefs:
        cells = cells_of_period(seabed.random_reliefs[0].period, seabed.spacing)
        return periodic_heights(seabed.random_reliefs, shape or (cells, cells), (cells, cells), seed)
    if seabed.relief.level:
        return np.zeros(shape or (FLAT_CELLS, FLAT_CELLS))
    if seabed.relief.detail and shape is None:
        heights = sample_heights(seabed.relief, seabed.spacing, seed=seed).heights
    else:
        heights = seabed.relief.sample(seabed.spacing, shape=shape).heights
    return np.asarray(heights - np.nanmean(heights)) if seabed.relief.measured else heights


def relief_picture(scene: Scene) -> NDArray[np.uint8]:
    """Heights of the bed of a scene as grey levels."""
    ground = build_ground(scene)
    if isinstance(ground, EndlessGround):
        heights = gather_tiles(ground.heights, (0, 0), (SHOWN, SHOWN))[::-1]
    else:
        heights = ground.heights[::-1]
    if heights.shape[1] <= FLAT_CELLS and (heights == heights[:, :1]).all():
        heights = np.tile(heights, (1, 256 // heights.shape[1]))
    low, high = np.nanmin(heights), np.nanmax(heights)
    if high == low:
        return np.zeros(heights.shape, dtype=np.uint8)
    return np.rint(np.nan_to_num((heights - low) / (high - low)) * 255.0).astype(np.uint8)
