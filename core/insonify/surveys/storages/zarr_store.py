"""Zarr stores: all tiles of a job in two arrays."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import parameter
from insonify.surveys.storages import IMAGES, MASKS, StorageKind, Tile

MARK = "#"  # between the store and the place in it in the name of an image


class ZarrStore(StorageKind):
    """Zarr stores with the arrays ``images`` and ``masks``, (tiles, pings, bins), and the names of the tiles."""

    rank = 30
    kind: Literal["zarr"] = "zarr"
    scenes: int = parameter(16, description="scenes of a job, whose tiles are stored together", ge=1, le=10_000)

    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write ``SPLIT/SHELF/JOB.zarr``: a chunk for each tile, all chunks of an array in one file."""
        if not tiles:
            return
        import zarr

        path = folder / tiles[0].told["split"] / shelf / f"{job}.zarr"
        group = zarr.create_group(path, attributes={"names": [tile.told["name"] for tile in tiles]})
        arrays = {IMAGES: [tile.image for tile in tiles], MASKS: [tile.mask for tile in tiles]}
        for name, array in ((name, np.stack(pixels)) for name, pixels in arrays.items()):
            group.create_array(name, data=array, chunks=(1, *array.shape[1:]), shards=array.shape)
        for place, tile in enumerate(tiles):
            tile.told["file"] = f"{path.relative_to(folder).as_posix()}{MARK}{place}"

    def read_image(self, folder: Path, file: str) -> NDArray[np.unsignedinteger]:
        """Read an image from its store."""
        import zarr

        path, _, place = file.partition(MARK)
        return np.asarray(zarr.open_array(folder / path / IMAGES, mode="r")[int(place)])
