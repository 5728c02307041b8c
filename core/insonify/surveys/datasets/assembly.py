"""Assembly of a data set: annotations, metadata and pictures from what its jobs told, one job at a time."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from insonify.io.atomic import replacing
from insonify.surveys.datasets.balance import draw_balance
from insonify.surveys.datasets.contact_sheet import ContactSheet
from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.engine.jobs import read_flag

METADATA, SHEET, BALANCE = "metadata.jsonl", "contact-sheet.png", "class-balance.png"
OF_SCENE = ("hash", "drawn")  # what metadata tells of the scene of a tile


@dataclass
class Totals:
    """Counts of a data set."""

    tiles: Counter[str] = field(default_factory=Counter)  # tiles of each split, and those without a target
    empty: Counter[str] = field(default_factory=Counter)
    targets: Counter[tuple[str, str]] = field(default_factory=Counter)  # annotated targets of each class and split

    def add(self, tile: Mapping[str, Any]) -> None:
        """Count a tile."""
        self.tiles[tile["split"]] += 1
        self.empty[tile["split"]] += not tile["targets"]
        self.targets.update((found["class"], tile["split"]) for found in tile["targets"])


def assemble(specification: DatasetSpecification, folder: Path, names: Iterable[str]) -> Totals:
    """Write the files that concern the whole data set."""
    totals, sheet = Totals(), ContactSheet(specification, folder)
    splits, classes = list(specification.splits), specification.classes
    with ExitStack() as stack:
        collectors = [stack.enter_context(kind.collect(folder, splits, classes)) for kind in specification.annotations]
        beside = stack.enter_context(replacing(folder / METADATA))
        metadata = stack.enter_context(open(beside, "w", encoding="utf-8"))
        for tile, scene in _tiles(folder, names):
            metadata.write(_line(tile, scene))
            for collector in (*collectors, totals, sheet):
                collector.add(tile)
    with replacing(folder / SHEET) as beside:
        sheet.write(beside)
    with replacing(folder / BALANCE) as beside:
        draw_balance(beside, totals.targets, totals.tiles, totals.empty, classes, splits)
    return totals


def _tiles(folder: Path, names: Iterable[str]) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Every tile with its scene."""
    for name in names:
        told = read_flag(folder, name)
        scenes = {scene["scene"]: scene for scene in told["scenes"]}
        for tile in told["tiles"]:
            yield tile, scenes[tile["scene"]]


def _line(tile: Mapping[str, Any], scene: Mapping[str, Any]) -> str:
    """Line of the metadata: the tile, without masks, and what was drawn for its scene."""
    targets = [
        {name: value and value["box"] if name in ("echo", "shadow", "both") else value for name, value in found.items()}
        for found in tile["targets"]
    ]
    told = {"file_name": tile["file"], **tile, "targets": targets, **{name: scene[name] for name in OF_SCENE}}
    del told["file"]
    return json.dumps(told, ensure_ascii=False) + "\n"
