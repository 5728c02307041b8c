"""Formats of annotations: COCO, with boxes and masks of every target, and YOLO, with a text of boxes per image."""

import json
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from pathlib import Path
from typing import IO, Any, Literal

from insonify.io.atomic import replacing, write_text
from insonify.io.object_store import in_store
from insonify.scene.base import Family, Kind, parameter

ANNOTATIONS = Family("annotations")
EXTENTS = ("echo", "shadow", "both")  # annotated parts of a target
Extent = Literal["echo", "shadow", "both"]
Collector = Callable[[Mapping[str, Any]], None]  # called with the annotations of one tile after the other


class AnnotationKind(Kind):
    """Format of annotations: files of each tile, files of the whole data set, or both."""

    family = ANNOTATIONS

    def of_tile(self, tile: Mapping[str, Any], classes: Sequence[str]) -> dict[str, tuple[str, bytes]]:
        """Suffix and content of files of one tile, by their folder, which lies beside the folder of the images."""
        return {}

    def collect(self, folder: Path, splits: Sequence[str], classes: Sequence[str]) -> AbstractContextManager[Collector]:
        """Open the files of the whole data set; they appear when the context ends without an error.

        Parameters
        ----------
        folder : Path
            Of the data set.
        splits, classes : sequence of str
        """
        return nullcontext(_ignore)


def _ignore(tile: Mapping[str, Any]) -> None:
    """Take a tile without writing anything."""


class Coco(AnnotationKind, kind="coco", rank=10):
    """COCO: ``coco-echo.json``, ``coco-shadow.json`` and ``coco-both.json`` in the folder of each split.

    Boxes are [x, y, width, height] in pixels. Masks are run lengths by columns, uncompressed, which pycocotools reads.
    """

    of: tuple[Extent, ...] = parameter(EXTENTS, "echo, shadow or both of a target; one file each", min_length=1)

    @contextmanager
    def collect(self, folder: Path, splits: Sequence[str], classes: Sequence[str]) -> Iterator[Collector]:
        """Write the files as tiles come: memory does not grow with their number."""
        with ExitStack() as stack:
            collectors = {
                split: [
                    stack.enter_context(_open_coco(folder / split / f"coco-{extent}.json", extent, classes))
                    for extent in self.of
                ]
                for split in splits
            }

            def add(tile: Mapping[str, Any]) -> None:
                for collect in collectors[tile["split"]]:
                    collect(tile)

            yield add


@contextmanager
def _open_coco(path: Path, extent: Extent, classes: Sequence[str]) -> Iterator[Collector]:
    """Open a file that appears when it is whole; annotations are written beside it and appended in the end."""
    numbers = {name: number for number, name in enumerate(classes, 1)}
    categories = [{"id": number, "name": name} for name, number in numbers.items()]
    if not in_store(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    with (
        replacing(path) as beside,
        open(beside, "w", encoding="utf-8", newline="") as images,
        tempfile.TemporaryFile("w+", encoding="utf-8", newline="", dir=beside.parent) as annotations,
    ):
        written: dict[IO[str], int] = {images: 0, annotations: 0}  # entries

        def append(file: IO[str], entry: Mapping[str, Any]) -> None:
            file.write((",\n" if written[file] else "") + json.dumps({"id": written[file] + 1, **entry}))
            written[file] += 1

        def add(tile: Mapping[str, Any]) -> None:
            height, width = tile["shape"]
            append(images, {"file_name": tile["file"], "width": width, "height": height})
            for found in tile["targets"]:
                if (region := found[extent]) is not None:
                    annotation = {
                        "image_id": written[images],
                        "category_id": numbers[found["class"]],
                        "bbox": region["box"],
                        "area": region["area"],
                        "segmentation": region["segmentation"],
                        "iscrowd": 0,
                    }
                    append(annotations, annotation)

        images.write(f'{{"categories": {json.dumps(categories)},\n"images": [\n')
        yield add
        images.write('],\n"annotations": [\n')
        annotations.seek(0)
        shutil.copyfileobj(annotations, images)
        images.write("]}\n")


class Yolo(AnnotationKind, kind="yolo", rank=20):
    """YOLO: ``labels`` beside ``images``, with a line for each target: class from 0, then centre and size as shares."""

    of: Extent = parameter("both", "what the box of a target encloses: echo, shadow or both")

    def of_tile(self, tile: Mapping[str, Any], classes: Sequence[str]) -> dict[str, tuple[str, bytes]]:
        """Text of boxes; empty for an image without targets."""
        lines, (rows, columns) = [], tile["shape"]
        for one in tile["targets"]:
            if one[self.of] is not None:
                x, y, width, height = one[self.of]["box"]
                shares = (x + 0.5 * width) / columns, (y + 0.5 * height) / rows, width / columns, height / rows
                lines.append(" ".join([str(classes.index(one["class"])), *(f"{share:.6f}" for share in shares)]) + "\n")
        return {"labels": (".txt", "".join(lines).encode())}

    @contextmanager
    def collect(self, folder: Path, splits: Sequence[str], classes: Sequence[str]) -> Iterator[Collector]:
        """Write ``data.yaml``; without ``path`` its folders are beside it, whatever folder a program runs in."""
        yield _ignore
        roles = {"validation": "val"}
        lines = [*(f"{roles.get(split, split)}: {split}/images" for split in splits), "names:" + " {}" * (not classes)]
        lines += [f"  {number}: {json.dumps(name)}" for number, name in enumerate(classes)]
        write_text(folder / "data.yaml", "\n".join(lines) + "\n")
