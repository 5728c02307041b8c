"""Shards of WebDataset: a tar archive for each job."""

from __future__ import annotations

import io
import json
import tarfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import parameter
from insonify.surveys.storages import IMAGES, MASKS, StorageKind, Tile
from insonify.surveys.storages.files import members

MARK = "#"  # between the archive and the member in the name of an image


class WebDataset(StorageKind):
    """Archives as WebDataset reads them: ``NAME.png``, ``NAME.mask.png``, ``NAME.json`` and annotations."""

    rank = 20
    kind: Literal["webdataset"] = "webdataset"
    scenes: int = parameter(16, description="scenes of a job, whose tiles are stored together", ge=1, le=10_000)

    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write ``SPLIT/SHELF/JOB.tar``; without a time, so that the same tiles give the same bytes."""
        if not tiles:
            return
        path = folder / tiles[0].told["split"] / shelf / f"{job}.tar"
        path.parent.mkdir(parents=True, exist_ok=True)
        with tarfile.open(path, "w", format=tarfile.USTAR_FORMAT) as archive:
            for tile in tiles:
                tile.told["file"] = f"{path.relative_to(folder).as_posix()}{MARK}{tile.told['name']}.png"
                for name, content in _members(tile):
                    entry = tarfile.TarInfo(name)
                    entry.size, entry.mode = len(content), 0o644
                    archive.addfile(entry, io.BytesIO(content))

    def read_image(self, folder: Path, file: str) -> NDArray[np.unsignedinteger]:
        """Read a picture from its archive."""
        from PIL import Image

        path, _, name = file.partition(MARK)
        with tarfile.open(folder / path) as archive, Image.open(archive.extractfile(name)) as picture:  # type: ignore[arg-type]  # a file
            return np.asarray(picture)


def _members(tile: Tile) -> Iterator[tuple[str, bytes]]:
    """Names and contents of what an archive holds of a tile; the name ends at the first dot."""
    endings = {IMAGES: "", MASKS: ".mask"}
    for folder, (suffix, content) in members(tile).items():
        yield f"{tile.told['name']}{endings.get(folder, '')}{suffix}", content
    yield f"{tile.told['name']}.json", json.dumps(tile.told).encode()
