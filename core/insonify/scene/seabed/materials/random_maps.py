"""Random maps of materials: patches, and bands of a fractal field."""

import numpy as np

from insonify.scene.base import metres, parameter, share
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.scene.seabed.materials.pattern import GRADES, graded_rows


class Patches(CompositeMap, kind="patches", rank=2):
    """Random patches with sharp borders, each of one of the materials."""

    of: tuple[Material, ...] = parameter(description="materials of the patches", min_length=2, max_length=32)
    size: float = metres(8.0, "typical width of a patch", (0.5, 50.0), least=1e-3, most=1e5)

    def indices(self, cells: Cells) -> Map:
        """Material of the patch that contains each cell."""
        return cells.patches(self.size, len(self.of))


class FractalMap(CompositeMap, kind="fractal", rank=3):
    """Bands of equal area between contours of a fractal field, one band a material."""

    of: tuple[Material, ...] = parameter(description="materials of the bands", min_length=2, max_length=32)
    beta: float = parameter(
        1.8, "amplitude exponent of the field; larger is smoother", ge=0.0, lt=5.0, slider=(0.5, 3.0)
    )

    softness: float = share(
        0.0, "share of the bed in transitions between bands, where the materials of both mix; 0: sharp borders"
    )

    def rows(self, frequency: float | None = None) -> tuple[tuple[str, ...], tuple[Reflectivity, ...]]:
        """Names and scattering parameters of the rows; with soft borders those of mixtures of two materials."""
        return graded_rows(self.of, frequency) if self.softness else super().rows(frequency)

    def indices(self, cells: Cells) -> Map:
        """Material of the band that contains each cell, or the row of its mixture."""
        count = len(self.of)
        if not self.softness:
            return cells.bands(self.beta, count)
        # Bands in steps of area, about their middles: a border lies halfway between two.
        place = (cells.bands(self.beta, GRADES) + 0.5) * (count / GRADES) - 0.5
        low = np.floor(place)
        level = np.clip(low + np.clip((place - low - 0.5) / self.softness + 0.5, 0.0, 1.0), 0.0, count - 1.0)
        return np.rint(level * ((GRADES - 1) / (count - 1))).astype(np.uint8)
