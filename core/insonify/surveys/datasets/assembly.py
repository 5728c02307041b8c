"""Assembly of a data set: annotations, metadata and pictures from what its jobs report, one job at a time."""

import json
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from heapq import heappush, heappushpop
from pathlib import Path
from typing import Any

import numpy as np

from insonify.io.atomic import replacing
from insonify.surveys.datasets.datasheet import CHECKSUMS, DATASHEET, Totals, write_checksums, write_datasheet
from insonify.surveys.datasets.scenes import hash_share
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.engine import read_flag
from insonify.surveys.storages import Pixels

METADATA, SHEET, BALANCE = "metadata.jsonl", "contact-sheet.png", "class-balance.png"
OF_SCENE = ("hash", "drawn")  # metadata of the scene of a tile
SHEET_COLUMNS, SHEET_ROWS = 8, 6  # of the contact sheet
SIDE, GAP = 176, 6  # pixels
EMPTY = 0.15  # share of the sheet for tiles without a target
COLOURS = {"echo": (255, 200, 60), "shadow": (80, 200, 255)}
PAPER = (24, 26, 30)
SIZE = (9.0, 3.6)  # inches of the balance of classes
TINTS = ("#1f7a8c", "#b3561d", "#9aa5b1", "#6a4c93", "#4f772d")


def assemble(specification: DatasetSpecification, folder: Path, names: Sequence[str]) -> Totals:
    """Write the files that concern the whole data set."""
    totals, sheet = Totals(), _ContactSheet(specification, folder)
    splits, classes = list(specification.splits), specification.classes
    with ExitStack() as stack:
        collectors = [stack.enter_context(kind.collect(folder, splits, classes)) for kind in specification.annotations]
        beside = stack.enter_context(replacing(folder / METADATA))
        metadata = stack.enter_context(open(beside, "w", encoding="utf-8", newline=""))
        for report in (read_flag(folder, name) for name in names):
            scenes = {scene["scene"]: scene for scene in report["scenes"]}
            for tile in report["tiles"]:
                metadata.write(_line(tile, scenes[tile["scene"]]))
                for collect in (*collectors, totals.add, sheet.add):
                    collect(tile)
    with replacing(folder / SHEET) as beside:
        sheet.write(beside)
    with replacing(folder / BALANCE) as beside:
        _draw_balance(beside, totals, classes, splits)
    with replacing(folder / DATASHEET) as beside:
        write_datasheet(beside, specification, folder, len(names) * specification.storage.scenes, totals)
    with replacing(folder / CHECKSUMS) as beside:
        write_checksums(beside, folder, totals.files)
    return totals


def _line(tile: Mapping[str, Any], scene: Mapping[str, Any]) -> str:
    """Line of the metadata: the tile, without masks, and what was drawn for its scene."""
    targets = [
        {name: value and value["box"] if name in ("echo", "shadow", "both") else value for name, value in found.items()}
        for found in tile["targets"]
    ]
    line = {"file_name": tile["file"], **tile, "targets": targets, **{name: scene[name] for name in OF_SCENE}}
    del line["file"]
    return json.dumps(line, ensure_ascii=False) + "\n"


class _ContactSheet:
    """Some tiles side by side with the boxes of their targets; each tile is chosen with the same probability."""

    def __init__(self, specification: DatasetSpecification, folder: Path) -> None:
        self._specification, self._folder = specification, folder
        empty = round(EMPTY * SHEET_COLUMNS * SHEET_ROWS) if specification.targets else SHEET_COLUMNS * SHEET_ROWS
        self._room = {True: SHEET_COLUMNS * SHEET_ROWS - empty, False: empty}
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
        chosen = (sorted(self._chosen[has_targets], key=lambda entry: entry[1]) for has_targets in (True, False))
        read = self._specification.storage.read_image
        draw_sheet(path, [(read(self._folder, tile["file"]), tile) for half in chosen for _, _, tile in half])


def draw_sheet(path: Path, tiles: Sequence[tuple[Pixels, Mapping[str, Any]]]) -> None:
    """Draw tiles side by side with the boxes of their targets: a PNG picture."""
    from PIL import Image

    rows = max(-(-len(tiles) // SHEET_COLUMNS), 1)
    sheet = Image.new("RGB", (SHEET_COLUMNS * (SIDE + GAP) + GAP, rows * (SIDE + GAP) + GAP), PAPER)
    for number, tile in enumerate(tiles):
        row, column = divmod(number, SHEET_COLUMNS)
        sheet.paste(_thumbnail(*tile), (GAP + column * (SIDE + GAP), GAP + row * (SIDE + GAP)))
    sheet.save(path, "png")


def _thumbnail(pixels: Pixels, tile: Mapping[str, Any]) -> Any:
    """Picture of a tile with its boxes."""
    from PIL import Image, ImageDraw

    eight_bits = pixels if pixels.dtype.itemsize == 1 else pixels >> 8
    small = Image.fromarray(eight_bits.astype(np.uint8)).resize((SIDE, SIDE), Image.Resampling.BOX).convert("RGB")
    draw = ImageDraw.Draw(small)
    height, width = tile["shape"]
    for found in tile["targets"]:
        for extent, colour in COLOURS.items():
            if found[extent] is not None:
                x, y, wide, high = found[extent]["box"]
                corners = x / width, y / height, (x + wide) / width, (y + high) / height
                draw.rectangle([SIDE * corner for corner in corners], outline=colour)
    return small


def _draw_balance(path: Path, totals: Totals, classes: Sequence[str], splits: Sequence[str]) -> None:
    """Draw how many targets of each class, and how many tiles with and without targets, each split has."""
    import matplotlib as mpl

    # lazy: slow to import
    from insonify.display.style import make_figure

    figure = make_figure(*SIZE, layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[max(len(classes), 1), 2])
    width = 0.8 / len(splits)
    for number, split in enumerate(splits):
        tint = TINTS[number % len(TINTS)]
        shift = (number - 0.5 * (len(splits) - 1)) * width
        counts = [totals.targets[name, split] for name in classes]
        left.bar_label(left.bar(np.arange(len(classes)) + shift, counts, width, color=tint, label=split), fontsize=8)
        counts = [totals.tiles[split] - totals.empty[split], totals.empty[split]]
        right.bar_label(right.bar(np.arange(2) + shift, counts, width, color=tint), fontsize=8)
    left.set_xticks(range(len(classes)), classes)
    left.set(ylabel="annotated targets")
    right.set_xticks(range(2), ["with targets", "without"])
    right.set(ylabel="tiles")
    left.legend(frameon=False, fontsize=9)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.margins(y=0.12)
    figure.savefig(path, dpi=110, metadata={"Software": f"Matplotlib {mpl.__version__}"})
