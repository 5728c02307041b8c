"""Annotations of YOLO: a text of boxes for each image, and the list of classes."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from insonify.io.atomic import replacing
from insonify.scene.base import parameter
from insonify.surveys.annotations import AnnotationKind, Collector, Extent, Idle


class Yolo(AnnotationKind):
    """YOLO: ``labels`` beside ``images``, with a line for each target: class from 0, then centre and size as shares."""

    rank = 20
    kind: Literal["yolo"] = "yolo"
    of: Extent = parameter("both", description="what of a target the box holds")

    def of_tile(self, tile: Mapping[str, Any], classes: Sequence[str]) -> dict[str, tuple[str, bytes]]:
        """Text of boxes; empty for an image without targets."""
        lines = [_line(classes.index(found["class"]), found[self.of]["box"], tile["shape"]) for found in self._of(tile)]
        return {"labels": (".txt", "".join(lines).encode())}

    def _of(self, tile: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
        return (found for found in tile["targets"] if found[self.of] is not None)

    @contextmanager
    def collect(self, folder: Path, splits: Sequence[str], classes: Sequence[str]) -> Iterator[Collector]:
        """Write ``data.yaml``."""
        yield Idle()
        lines = ["path: .", *(f"{_ROLES.get(split, split)}: {split}/images" for split in splits), "names:"]
        lines += [f"  {number}: {json.dumps(name)}" for number, name in enumerate(classes)]
        with replacing(folder / "data.yaml") as beside:
            beside.write_text("\n".join(lines) + "\n", encoding="utf-8")


_ROLES = {"validation": "val"}


def _line(number: int, box: Sequence[int], shape: Sequence[int]) -> str:
    (x, y, width, height), (rows, columns) = box, shape
    centre = (x + 0.5 * width) / columns, (y + 0.5 * height) / rows
    return " ".join([str(number), *(f"{share:.6f}" for share in (*centre, width / columns, height / rows))]) + "\n"
