"""Maps with the borders of a fractal field."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material


class FractalMap(CompositeMap):
    """Bands of equal area between contours of a fractal field, one band a material."""

    rank = 3
    kind: Literal["fractal"] = "fractal"
    of: tuple[Material, ...] = parameter(description="materials of the bands", min_length=2, max_length=32)
    beta: float = parameter(
        1.8, "amplitude exponent of the field; larger is smoother", ge=0.0, lt=5.0, slider=(0.5, 3.0)
    )

    def indices(self, cells: Cells) -> Map:
        """Material of the band that contains each cell."""
        return cells.bands(self.beta, len(self.of))
