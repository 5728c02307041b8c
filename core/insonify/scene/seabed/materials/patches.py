"""Maps of patches."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import length, parameter
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material


class Patches(CompositeMap):
    """Random patches with sharp borders, each of one of the materials."""

    rank = 2
    kind: Literal["patches"] = "patches"
    of: tuple[Material, ...] = parameter(description="materials of the patches", min_length=2, max_length=32)
    size: float = length(8.0, "typical width of a patch", (0.5, 50.0), least=1e-3, most=1e5)

    def indices(self, cells: Cells) -> Map:
        """Material of the patch that contains each cell."""
        return cells.patches(self.size, len(self.of))
