"""Random maps of materials: patches, and bands of a fractal field."""

from insonify.scene.base import metres, parameter
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material


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

    def indices(self, cells: Cells) -> Map:
        """Material of the band that contains each cell."""
        return cells.bands(self.beta, len(self.of))
