"""Heights of a seabed as arrays and as a picture."""

import numpy as np

from insonify.arrays import Bytes, Floats
from insonify.scene import Scene, SceneError
from insonify.scene.seabed import Seabed
from insonify.terrain.build import FLAT_CELLS, build_ground, cells_of_period, sample_heights
from insonify.terrain.endless_field import Nodes, gather_tiles
from insonify.terrain.endless_ground import EndlessGround
from insonify.terrain.random_heights import endless_heights, periodic_heights

SHOWN = 1024  # nodes along a side of the picture of endless ground


def relief(seabed: Seabed, shape: tuple[int, int] | None = None, *, seed: int = 1) -> Floats:
    """Heights of a seabed above its mean.

    Parameters
    ----------
    seabed : Seabed
        Depth, spacing and relief.
    shape : (ny, nx), optional
        Samples of one period along y and x, or nodes of endless ground from the origin; the grid of the seabed when
        left out. The same seed gives the same landscape on every shape; its rms is exact on the grid of the seabed.
    seed : int
        Seed of the landscape.

    Returns
    -------
    (ny, nx) float64
        Metres above the mean bed, NaN where there is none; axis 0 is y, axis 1 is x, both increasing.

    Raises
    ------
    SceneError
        If a shape is given for a measured bed, which has its own, if it has no nodes, or if the bed cannot be built.
    """
    if shape is not None and min(shape) < 1:
        raise SceneError(f"shape: {shape} has no nodes; give at least (1, 1)")
    if seabed.endless:
        heights_of = endless_heights(seabed.random_reliefs, seabed.spacing, seed)
        # Tile by tile, so that any shape takes little memory.
        return gather_tiles(lambda *place: heights_of(Nodes.of_tile(*place)), (0, 0), shape or (SHOWN, SHOWN))
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


def relief_picture(scene: Scene) -> Bytes:
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
