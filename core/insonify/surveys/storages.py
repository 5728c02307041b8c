"""Storage of images and masks: pictures in folders, archives of WebDataset, Zarr stores."""

import io
import json
import tarfile
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Bytes
from insonify.scene.base import Family, Kind, parameter

STORAGES = Family("storages")
IMAGES, MASKS = "images", "masks"
MARK = "#"  # in the name of an image, between an archive or store and the place in it
Pixels = NDArray[np.unsignedinteger]


@dataclass(frozen=True, eq=False)
class Tile:
    """A tile of a record, ready to be stored."""

    image: Pixels  # (pings, bins) grey levels
    mask: Bytes  # (pings, bins) class of every bin
    description: dict[str, Any]  # ``name``, ``split``, ``shape``, ``targets``, …; `StorageKind.write` adds ``file``
    # Suffix and content of files of annotations, by their folder beside that of the images.
    labels: dict[str, tuple[str, bytes]] = field(default_factory=dict)


class StorageKind(Kind):
    """How the tiles of a job are stored."""

    family = STORAGES
    scenes: int = parameter(1, "scenes that one job simulates; it stores their tiles together", ge=1, le=10_000)

    @abstractmethod
    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write the tiles of one job, and enter the file of each image into the tile's ``description["file"]``.

        Parameters
        ----------
        folder : Path
            Stands for the folder of the data set.
        job : str
            Number of the job.
        shelf : str
            Folder that jobs of nearby numbers share.
        tiles : sequence of Tile
            At least one; all belong to one split.
        """

    @abstractmethod
    def read_image(self, folder: Path, file: str) -> Pixels:
        """Read an image by the name that `write` noted."""


class Files(StorageKind, kind="files", rank=10):
    """PNG pictures, a file for each image and each mask."""

    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write ``SPLIT/images/SHELF/NAME.png``, the same below ``masks``, and annotations beside."""
        for tile in tiles:
            place = folder / tile.description["split"]
            for beside, (suffix, content) in _members(tile).items():
                path = place / beside / shelf / f"{tile.description['name']}{suffix}"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            tile.description["file"] = f"{tile.description['split']}/{IMAGES}/{shelf}/{tile.description['name']}.png"

    def read_image(self, folder: Path, file: str) -> Pixels:
        """Read a picture."""
        with (folder / file).open("rb") as stream:
            return _decode(stream)


class WebDataset(StorageKind, kind="webdataset", rank=20):
    """Archives as WebDataset reads them: ``NAME.png``, ``NAME.mask.png``, ``NAME.json`` and annotations."""

    scenes: int = parameter(16, "scenes that one job simulates; it stores their tiles together", ge=1, le=10_000)

    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write ``SPLIT/SHELF/JOB.tar``; without a time, so that the same tiles give the same bytes."""
        path = folder / tiles[0].description["split"] / shelf / f"{job}.tar"
        path.parent.mkdir(parents=True, exist_ok=True)
        with tarfile.open(path, "w", format=tarfile.USTAR_FORMAT) as archive:
            for tile in tiles:
                tile.description["file"] = f"{path.relative_to(folder).as_posix()}{MARK}{tile.description['name']}.png"
                members = {
                    f".mask{suffix}" if beside == MASKS else suffix: content
                    for beside, (suffix, content) in _members(tile).items()
                }
                # WebDataset groups members up to the first dot.
                for ending, content in (members | {".json": json.dumps(tile.description).encode()}).items():
                    entry = tarfile.TarInfo(tile.description["name"] + ending)
                    entry.size, entry.mode = len(content), 0o644
                    archive.addfile(entry, io.BytesIO(content))

    def read_image(self, folder: Path, file: str) -> Pixels:
        """Read a picture from its archive."""
        path, _, name = file.partition(MARK)
        with (folder / path).open("rb") as stream, tarfile.open(fileobj=stream) as archive:
            return _decode(archive.extractfile(name))


class ZarrStore(StorageKind, kind="zarr", rank=30):
    """Zarr stores with the arrays ``images`` and ``masks``, (tiles, pings, bins), and the names and shapes of tiles.

    Tiles that are smaller than the largest of their job are padded with zeros at their ends.
    """

    scenes: int = parameter(16, "scenes that one job simulates; it stores their tiles together", ge=1, le=10_000)

    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write ``SPLIT/SHELF/JOB.zarr``: a chunk for each tile, all chunks of an array in one file."""
        import zarr

        path = folder / tiles[0].description["split"] / shelf / f"{job}.zarr"
        shapes: Any = [list(tile.image.shape) for tile in tiles]
        group = zarr.create_group(path, attributes={"names": [tile.description["name"] for tile in tiles]})
        for name, pixels in ((IMAGES, [tile.image for tile in tiles]), (MASKS, [tile.mask for tile in tiles])):
            array = np.zeros((len(tiles), *np.max(shapes, axis=0)), pixels[0].dtype)
            for place, (pings, bins) in enumerate(shapes):
                array[place, :pings, :bins] = pixels[place]
            chunks, attributes = (1, *array.shape[1:]), {"shapes": shapes}
            group.create_array(name, data=array, chunks=chunks, shards=array.shape, attributes=attributes)
        for place, tile in enumerate(tiles):
            tile.description["file"] = f"{path.relative_to(folder).as_posix()}{MARK}{place}"

    def read_image(self, folder: Path, file: str) -> Pixels:
        """Read an image from its store."""
        import zarr

        path, _, place = file.partition(MARK)
        images = zarr.open_array(str(folder / path / IMAGES), mode="r")
        shapes: Any = images.attrs["shapes"]
        pings, bins = shapes[int(place)]
        return np.asarray(images[int(place), :pings, :bins])


def _members(tile: Tile) -> dict[str, tuple[str, bytes]]:
    """Suffix and content of all files of a tile, by folder: image and mask as PNG of 8 or 16 bits, annotations."""
    from PIL import Image

    members = {}
    for beside, pixels in ((IMAGES, tile.image), (MASKS, tile.mask)):
        buffer = io.BytesIO()
        Image.fromarray(pixels).save(buffer, "png", compress_level=4)
        members[beside] = ".png", buffer.getvalue()
    return members | tile.labels


def _decode(source: Any) -> Pixels:
    """Read a PNG picture from a path or an open file."""
    from PIL import Image

    with Image.open(source) as picture:
        return np.asarray(picture)
