"""Formats of annotations, one file a kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, Literal, Protocol

from insonify.scene.base import Family, Kind

ANNOTATIONS = Family("annotations", "insonify.surveys.annotations")
EXTENTS = ("echo", "shadow", "both")  # what of a target is annotated
Extent = Literal["echo", "shadow", "both"]


class Collector(Protocol):
    """Takes what is told of every tile in order."""

    def add(self, tile: Mapping[str, Any]) -> None:
        """Take one tile, as `insonify.surveys.datasets.tiles.Tile.told` has it."""


class Idle:
    """Takes tiles and does nothing with them."""

    def add(self, tile: Mapping[str, Any]) -> None:
        """Take one tile."""


class AnnotationKind(Kind):
    """Format of annotations: files of each tile, files of the whole data set, or both."""

    family = ANNOTATIONS

    def of_tile(self, tile: Mapping[str, Any], classes: Sequence[str]) -> dict[str, tuple[str, bytes]]:
        """Suffix and content of files of one tile, by the folder beside that of the images."""
        del tile, classes
        return {}

    def collect(self, folder: Path, splits: Sequence[str], classes: Sequence[str]) -> AbstractContextManager[Collector]:
        """Open the files of the whole data set; they appear when the context ends without an error.

        Parameters
        ----------
        folder : Path
            Of the data set.
        splits, classes : sequence of str
        """
        del folder, splits, classes
        return nullcontext(Idle())
