"""Storage of images and masks, one file a kind."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import Family, Kind, parameter

STORAGES = Family("storages", "insonify.surveys.storages")
IMAGES, MASKS = "images", "masks"


@dataclass(frozen=True, eq=False)
class Tile:
    """A tile of a record, ready to be stored."""

    image: NDArray[np.unsignedinteger]  # (pings, bins) grey levels
    mask: NDArray[np.uint8]  # (pings, bins) class of every bin
    # What is told of it: ``name``, ``split``, ``shape``, ``targets`` and more; `StorageKind.write` adds ``file``.
    told: dict[str, Any]
    # Suffix and content of files of annotations, by their folder beside that of the images.
    labels: dict[str, tuple[str, bytes]] = field(default_factory=dict)


class StorageKind(Kind):
    """How the tiles of a job are stored."""

    family = STORAGES
    scenes: int = parameter(1, description="scenes of a job, whose tiles are stored together", ge=1, le=10_000)

    @abstractmethod
    def write(self, folder: Path, job: str, shelf: str, tiles: Sequence[Tile]) -> None:
        """Write the tiles of one job, all of one split, and tell each where its image is: ``told["file"]``.

        Parameters
        ----------
        folder : Path
            Stands for that of the data set.
        job : str
            Number of the job.
        shelf : str
            Folder that jobs of nearby numbers share.
        tiles : sequence of Tile
        """

    @abstractmethod
    def read_image(self, folder: Path, file: str) -> NDArray[np.unsignedinteger]:
        """Read an image by what `write` told of it."""
