"""Contact sheet: some tiles of a data set side by side, with the boxes of their targets."""

from __future__ import annotations

from collections.abc import Mapping
from heapq import heappush, heappushpop
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.draws import hash_share

COLUMNS, ROWS = 8, 6
SIDE, GAP = 176, 6  # pixels
EMPTY = 0.15  # share of the sheet for tiles without a target
COLOURS = {"echo": (255, 200, 60), "shadow": (80, 200, 255)}
PAPER = (24, 26, 30)


class ContactSheet:
    """Sheet that tiles are drawn for as they come, each with the same probability."""

    def __init__(self, specification: DatasetSpecification, folder: Path) -> None:
        self._specification, self._folder = specification, folder
        empty = round(EMPTY * COLUMNS * ROWS) if specification.targets else COLUMNS * ROWS
        self._room = {True: COLUMNS * ROWS - empty, False: empty}
        self._chosen: dict[bool, list[tuple[float, str, Mapping[str, Any]]]] = {True: [], False: []}

    def add(self, tile: Mapping[str, Any]) -> None:
        """Take a tile, which may replace another one: those with the least hash stay."""
        chosen, room = self._chosen[bool(tile["targets"])], self._room[bool(tile["targets"])]
        entry = (-hash_share(self._specification.seed, tile["scene"], tile["name"]), tile["name"], tile)
        if len(chosen) < room:
            heappush(chosen, entry)
        elif room:
            heappushpop(chosen, entry)

    def write(self, path: Path) -> None:
        """Draw the sheet: a PNG picture."""
        from PIL import Image

        tiles = [
            tile
            for has_targets in (True, False)
            for _, _, tile in sorted(self._chosen[has_targets], key=lambda e: e[1])
        ]
        rows = max(-(-len(tiles) // COLUMNS), 1)
        sheet = Image.new("RGB", (COLUMNS * (SIDE + GAP) + GAP, rows * (SIDE + GAP) + GAP), PAPER)
        for number, tile in enumerate(tiles):
            row, column = divmod(number, COLUMNS)
            sheet.paste(self._thumbnail(tile), (GAP + column * (SIDE + GAP), GAP + row * (SIDE + GAP)))
        sheet.save(path, "png")

    def _thumbnail(self, tile: Mapping[str, Any]) -> Any:
        """Picture of a tile with its boxes."""
        from PIL import Image, ImageDraw

        pixels = self._specification.storage.read_image(self._folder, tile["file"])
        small = Image.fromarray(_bytes(pixels)).resize((SIDE, SIDE), Image.Resampling.BOX).convert("RGB")
        draw = ImageDraw.Draw(small)
        height, width = tile["shape"]
        for found in tile["targets"]:
            for extent, colour in COLOURS.items():
                if found[extent] is not None:
                    x, y, wide, high = found[extent]["box"]
                    corners = x / width, y / height, (x + wide) / width, (y + high) / height
                    draw.rectangle([SIDE * corner for corner in corners], outline=colour)
        return small


def _bytes(pixels: NDArray[np.unsignedinteger]) -> NDArray[np.uint8]:
    """Grey levels of 8 bits."""
    return pixels.astype(np.uint8) if pixels.dtype.itemsize == 1 else (pixels >> 8).astype(np.uint8)
