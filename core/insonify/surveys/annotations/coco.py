"""Annotations of COCO: boxes and masks of every target, one file for each split and extent."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, Any, Literal

from insonify.io.atomic import replacing
from insonify.scene.base import parameter
from insonify.surveys.annotations import EXTENTS, AnnotationKind, Collector, Extent


class Coco(AnnotationKind):
    """COCO: ``coco-echo.json``, ``coco-shadow.json`` and ``coco-both.json`` in the folder of each split.

    Boxes are [x, y, width, height] in pixels. Masks are run lengths by columns, uncompressed, which pycocotools reads.
    """

    rank = 10
    kind: Literal["coco"] = "coco"
    of: tuple[Extent, ...] = parameter(EXTENTS, description="what of a target is annotated, a file each", min_length=1)

    @contextmanager
    def collect(self, folder: Path, splits: Sequence[str], classes: Sequence[str]) -> Iterator[Collector]:
        """Write the files as tiles come: memory does not grow with their number."""
        with ExitStack() as stack:
            files = {
                (split, extent): stack.enter_context(_open(folder / split / f"coco-{extent}.json", extent, classes))
                for split in splits
                for extent in self.of
            }
            yield _Collector(files)


class _Collector:
    """Passes tiles on to the files of their split."""

    def __init__(self, files: Mapping[tuple[str, Extent], _CocoFile]) -> None:
        self._files = files

    def add(self, tile: Mapping[str, Any]) -> None:
        for (split, _), file in self._files.items():
            if split == tile["split"]:
                file.add(tile)


class _CocoFile:
    """A file while it is written: images go into it, annotations into another that is appended in the end."""

    def __init__(self, images: IO[str], annotations: IO[str], extent: Extent, classes: Sequence[str]) -> None:
        self._images, self._annotations, self._extent = images, annotations, extent
        self._numbers = {name: number for number, name in enumerate(classes, 1)}
        self._image = self._annotation = 0

    def add(self, tile: Mapping[str, Any]) -> None:
        """Add an image and the annotations of its targets."""
        height, width = tile["shape"]
        self._image += 1
        image = {"id": self._image, "file_name": tile["file"], "width": width, "height": height}
        _append(self._images, image, self._image)
        for found in tile["targets"]:
            region = found[self._extent]
            if region is not None:
                self._annotation += 1
                _append(self._annotations, self._annotate(found, region), self._annotation)

    def _annotate(self, found: Mapping[str, Any], region: Mapping[str, Any]) -> dict[str, Any]:
        return {
            "id": self._annotation,
            "image_id": self._image,
            "category_id": self._numbers[found["class"]],
            "bbox": region["box"],
            "area": region["area"],
            "segmentation": region["segmentation"],
            "iscrowd": 0,
        }


def _append(file: IO[str], entry: Mapping[str, Any], number: int) -> None:
    file.write(("" if number == 1 else ",\n") + json.dumps(entry))


@contextmanager
def _open(path: Path, extent: Extent, classes: Sequence[str]) -> Iterator[_CocoFile]:
    """Open a file that appears when it is whole."""
    categories = [{"id": number, "name": name} for number, name in enumerate(classes, 1)]
    path.parent.mkdir(parents=True, exist_ok=True)
    with (
        replacing(path) as beside,
        open(beside, "w", encoding="utf-8") as images,
        tempfile.TemporaryFile("w+", encoding="utf-8", dir=path.parent) as annotations,
    ):
        images.write(f'{{"categories": {json.dumps(categories)},\n"images": [\n')
        yield _CocoFile(images, annotations, extent, classes)
        images.write('],\n"annotations": [\n')
        annotations.seek(0)
        shutil.copyfileobj(annotations, images)
        images.write("]}\n")
