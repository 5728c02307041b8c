"""Pictures in folders."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.surveys.storages import IMAGES, MASKS, StorageKind, Tile


class Files(StorageKind):
    """PNG pictures, a file for each image and each mask."""

    rank = 10
    kind: Literal["files"] = "files"

    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write ``SPLIT/images/SHELF/NAME.png``, the same below ``masks``, and annotations beside."""
        del job
        for tile in tiles:
            place = folder / tile.told["split"]
            for beside, (suffix, content) in members(tile).items():
                path = place / beside / shelf / f"{tile.told['name']}{suffix}"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            tile.told["file"] = f"{tile.told['split']}/{IMAGES}/{shelf}/{tile.told['name']}.png"

    def read_image(self, folder: Path, file: str) -> NDArray[np.unsignedinteger]:
        """Read a picture."""
        from PIL import Image

        with Image.open(folder / file) as picture:
            return np.asarray(picture)


def members(tile: Tile) -> dict[str, tuple[str, bytes]]:
    """Suffix and content of all files of a tile, by folder: image, mask, annotations."""
    pictures = {IMAGES: tile.image, MASKS: tile.mask}
    return {beside: (".png", encode_png(pixels)) for beside, pixels in pictures.items()} | tile.labels


def encode_png(pixels: NDArray[np.unsignedinteger]) -> bytes:
    """Encode grey levels of 8 or 16 bits, or the bytes of a colour picture, as PNG."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, "png", compress_level=4)
    return buffer.getvalue()
