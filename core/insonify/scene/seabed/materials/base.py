"""Base of maps of materials, with the defaults of all that the rest of the program uses of a map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from insonify.io.georeference import Georeference
from insonify.scene.base import Declaration, parameter
from insonify.scene.kinds import Family, KindOf
from insonify.scene.seabed.materials.reflectivity import Reflectivity

if TYPE_CHECKING:
    from insonify.scene.seabed.materials.uniform import Material

MATERIAL_MAPS = Family("material_maps", "insonify.scene.seabed.materials")
PERIOD = 102.4  # m, after which a level bed repeats that has no period of its own
Map = NDArray[np.uint8]


class Cells(Protocol):
    """Cells of a bed on which a map is laid, and the random fields that the terrain makes over them."""

    @property
    def shape(self) -> tuple[int, int]:
        """Cells along y and x."""

    @property
    def size(self) -> tuple[float, float]:
        """Extent along x and y, in metres."""

    @property
    def periodic(self) -> bool:
        """Whether the bed repeats after its extent."""

    @property
    def place(self) -> Georeference | None:
        """Place of the local (0, 0) on Earth, for a map that lies on Earth too."""

    def centres(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Local x and y of the cells' middles, (nx,) and (ny,), in metres."""

    def patches(self, size: float, count: int) -> Map:
        """Index below ``count`` of the random patch, about ``size`` metres wide, that each cell lies in."""

    def bands(self, beta: float, count: int) -> Map:
        """Index below ``count`` of bands of equal area of a fractal field of that exponent."""


class MaterialMap(Declaration):
    """Map of the materials of a bed; a kind declares its ``kind``, its fields, its `materials` and their `indices`."""

    family = MATERIAL_MAPS
    on_a_map: ClassVar[bool] = False  # whether it lies on Earth, not on the bed
    kind: str = parameter(description="kind of map")

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials of the map."""
        raise NotImplementedError(f"the map {self.kind!r} declares no materials")

    def indices(self, cells: Cells) -> Map:
        """Row of the table of materials for each cell, (ny, nx).

        Raises
        ------
        SceneError
            If a file cannot be read: one sentence that begins with the name of the field.
        """
        raise NotImplementedError(f"the map {self.kind!r} declares no indices")

    def rows(self) -> tuple[tuple[str, ...], tuple[Reflectivity, ...]]:
        """Names and numbers of the rows of its table of materials."""
        materials = self.materials
        return tuple(one.name for one in materials), tuple(one.reflectivity for one in materials)

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Cells along y and x after which a level bed of it repeats.

        Parameters
        ----------
        spacing : float
            Metres between nodes.
        fewest, most : int
            Cells a side of a level bed.

        Raises
        ------
        SceneError
            If they cannot hold it; begins with the name of the field.
        """
        cells = int(np.clip(round(PERIOD / spacing), fewest, most))
        return cells, cells

    @property
    def layout(self) -> MaterialMap:
        """The map without the scattering parameters of its materials, on which no border depends."""
        return self

    @property
    def version(self) -> tuple[int, int] | None:
        """Version of the file that it is read from, None if there is none."""
        return None


AnyMaterialMap = Annotated[MaterialMap, KindOf(MATERIAL_MAPS, default="uniform", text="uniform")]
