"""Datasheet of a data set (Gebru et al. 2021), and checksums of its images."""

import hashlib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from insonify.surveys.datasets.specification import DatasetSpecification
from insonify.surveys.engine import FLAGS
from insonify.surveys.schedulers import read_build
from insonify.surveys.storages import MARK

DATASHEET, CHECKSUMS = "datasheet.md", "SHA256SUMS"
TEXT = """# Datasheet: {title}

{description}

## Motivation

Made to train and to test programs that detect or classify what side-scan sonar shows. Every image is simulated;
none is a recording.

## Composition

{images} images of {scenes} scenes. An image shows a part of a record of one side; each scene is drawn anew and lies
in one split alone.

{table}

Images have {bits} bits a pixel. Beside each lie a mask (class of every pixel) and annotations ({annotations})
with boxes of echoes, shadows and both. `metadata.jsonl` has a line for each image with all that was drawn; the
files in `{flags}` hold the scenes in full, from which every image can be made again. No person and no
confidential place is shown.

## Collection

Scenes are drawn by hashing the seed {seed} and simulated with a tolerance of {tolerance:g} % of a record, by
{build}.

## Preprocessing

{cut} Grey levels are displayed as drawn; `metadata.jsonl` says how.

## Uses

What the simulation leaves out (diffraction, elastic echoes, penetration of the bed and more) is listed with its
size in the documentation of insonify under *limits*. Test on real recordings whatever is trained on these
images before it is relied on.

## Distribution and maintenance

Whoever made the set decides on its licence. `sha256sum -c {checksums}` tells whether files were changed. The
same specification, versions and processor make the same bytes again; `--scenes` adds more.
"""


@dataclass
class Totals:
    """Counts of a data set."""

    tiles: Counter[str] = field(default_factory=Counter)  # tiles of each split, and those without a target
    empty: Counter[str] = field(default_factory=Counter)
    targets: Counter[tuple[str, str]] = field(default_factory=Counter)  # annotated targets of each class and split
    files: list[str] = field(default_factory=list)  # of images

    def add(self, tile: Mapping[str, Any]) -> None:
        """Count a tile."""
        self.files.append(tile["file"])
        self.tiles[tile["split"]] += 1
        self.empty[tile["split"]] += not tile["targets"]
        self.targets.update((found["class"], tile["split"]) for found in tile["targets"])


def write_datasheet(path: Path, specification: DatasetSpecification, folder: Path, scenes: int, totals: Totals) -> None:
    """Write what the set holds and how it was made, as Markdown."""
    build = read_build(folder / FLAGS)
    text = TEXT.format(
        title=specification.title,
        description=specification.description.strip() or "No description was given.",
        images=totals.tiles.total(),
        scenes=scenes,
        table="\n".join(_table(specification, totals)),
        bits=specification.images.bits,
        annotations=", ".join(kind.kind for kind in specification.annotations) or "none",
        flags=FLAGS,
        seed=specification.seed,
        tolerance=100.0 * specification.tolerance,
        build=", ".join(f"{name} {value}" for name, value in build._asdict().items()) if build else "an unknown build",
        cut="Chips are cut about targets, and from the bed."
        if specification.chips is not None
        else "Records are tiled.",
        checksums=CHECKSUMS,
    )
    path.write_text(text, encoding="utf-8", newline="\n")


def _table(specification: DatasetSpecification, totals: Totals) -> list[str]:
    """Rows of the table of splits."""
    classes = specification.classes
    rows: list[Sequence[object]] = [("split", "images", "without a target", *classes), ("---",) * (3 + len(classes))]
    for split in specification.splits:
        targets = (totals.targets[name, split] for name in classes)
        rows.append((split, totals.tiles[split], totals.empty[split], *targets))
    return [f"| {' | '.join(map(str, row))} |" for row in rows]


def write_checksums(path: Path, folder: Path, files: Iterable[str]) -> None:
    """Write the SHA-256 of files that hold images, or of all in a folder that does, as ``sha256sum`` checks them."""
    places = dict.fromkeys(folder / name.partition(MARK)[0] for name in files)
    with open(path, "w", encoding="utf-8", newline="\n") as lines:
        for place in places:
            for file in sorted(place.rglob("*")) if place.is_dir() else [place]:
                if file.is_file():
                    digest = hashlib.sha256(file.read_bytes()).hexdigest()
                    lines.write(f"{digest}  {file.relative_to(folder).as_posix()}\n")
