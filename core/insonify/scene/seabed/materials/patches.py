"""Maps of patches."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material


class Patches(CompositeMap):
    """Random patches with sharp borders, each of one of the materials."""

    rank = 2
    kind: Literal["patches"] = "patches"
    of: tuple[Material, ...] = parameter(description="materials of the patches", min_length=2, max_length=32)
    size: float = parameter(
        8.0, unit="m", description="typical width of a patch", ge=1e-3, le=1e5, slider=(0.5, 50.0), log=True
    )

    def indices(self, cells: Cells) -> Map:
        """Material of the patch that contains each cell."""
        return cells.patches(self.size, len(self.of))
