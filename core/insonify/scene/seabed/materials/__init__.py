"""Maps of materials: their base classes and the map of a single material."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Protocol

import numpy as np
from pydantic import field_validator, model_validator

from insonify.arrays import Bytes, Floats
from insonify.io.georeference import Georeference
from insonify.scene.base import Declaration, Family, KindOf, parameter, share
from insonify.scene.seabed.materials.catalogue import MATERIALS, Reflectivity, check_albedo
from insonify.scene.seabed.materials.sediments import Sediment

MATERIAL_MAPS = Family("material_maps", "insonify.scene.seabed.materials")
PERIOD = 102.4  # m, after which a level bed without a period of its own repeats
Map = Bytes


class Cells(Protocol):
    """Cells of a bed to which a map assigns materials, and random fields over them."""

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
        """Map coordinates of the local (0, 0), for a map with coordinates of its own."""

    def centres(self) -> tuple[Floats, Floats]:
        """Local x and y of the cells' middles, (nx,) and (ny,), in metres."""

    def patches(self, size: float, count: int) -> Map:
        """Index below ``count`` of the random patch, about ``size`` metres wide, that contains each cell."""

    def bands(self, beta: float, count: int) -> Map:
        """Index below ``count`` of bands of equal area of a fractal field of that exponent."""


class MaterialMap(Declaration):
    """Map of the materials of a bed; a kind declares its ``kind``, its fields, its `materials` and their `indices`."""

    family = MATERIAL_MAPS
    on_a_map: ClassVar[bool] = False  # whether it has map coordinates of its own
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
            If a file cannot be read; the message begins with the name of the field.
        """
        raise NotImplementedError(f"the map {self.kind!r} declares no indices")

    def rows(self, frequency: float | None = None) -> tuple[tuple[str, ...], tuple[Reflectivity, ...]]:
        """Names and scattering parameters of the rows of its table of materials.

        Parameters
        ----------
        frequency : float or None
            Hz, at which named sediments are fitted to their model; None for the law of light.
        """
        materials = self.materials
        return tuple(one.name for one in materials), tuple(one.reflectivity_at(frequency) for one in materials)

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Cells along y and x after which a level bed with this map repeats.

        Parameters
        ----------
        spacing : float
            Metres between nodes.
        fewest, most : int
            Limits of the cells along a side.

        Raises
        ------
        SceneError
            If the map needs more cells; the message begins with the name of the field.
        """
        cells = int(np.clip(round(PERIOD / spacing), fewest, most))
        return cells, cells

    @property
    def layout(self) -> MaterialMap:
        """The map without the scattering parameters of its materials, on which no border depends."""
        return self


class Material(MaterialMap, kind="uniform", rank=1):
    """One material: a name, and numbers that override those of the named material."""

    name: str = parameter("medium_sand", "named material, whose values apply to all fields that are left out")
    diffuse: float | None = share(None, "share of energy scattered evenly (Lambert)")
    specular: float | None = share(None, "share of energy in the mirror lobe (Phong)")
    shininess: float | None = parameter(
        None,
        "exponent n of the mirror lobe, that of facets with an rms slope of 1/(2√n)",
        ge=1.0,
        le=1000.0,
        slider=(1.0, 200.0),
        log=True,
    )
    reflection: float | None = share(None, "share of the amplitude reflected specularly at normal incidence (R0)")
    speed_ratio: float | None = parameter(
        None, "speed of sound inside over that of water", ge=0.1, le=10.0, slider=(0.5, 5.0), log=True
    )
    speckle_shape: float | None = parameter(
        None,
        "shape of K speckle on this material; fewer scatterers: smaller shape, spikier speckle",
        ge=0.01,
        le=1e4,
        slider=(0.1, 100.0),
        log=True,
    )

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"name": value} if isinstance(value, str) else value

    @field_validator("name")
    @classmethod
    def _known(cls, name: str) -> str:
        if name not in MATERIALS:
            raise ValueError(f"is not a known material; choose one of {', '.join(MATERIALS)}")
        return name

    @model_validator(mode="after")
    def _albedo_within_1(self) -> Material:
        check_albedo(*self.reflectivity[:2])
        return self

    @property
    def reflectivity(self) -> Reflectivity:
        """Scattering parameters by the law of light: the given ones, else the named material's."""
        return self.reflectivity_at(None)

    @property
    def model(self) -> Sediment | None:
        """Sediment of the backscatter model to which the material is fitted; None for a given diffuse share."""
        return MATERIALS[self.name].model if self.diffuse is None else None

    def reflectivity_at(self, frequency: float | None) -> Reflectivity:
        """Scattering parameters in force at a frequency in Hz, None for law `light`: given ones, or fitted."""
        numbers = {field: getattr(self, field) for field in Reflectivity._fields}
        given = {field: number for field, number in numbers.items() if number is not None}
        named = MATERIALS[self.name].reflectivity_at(None if self.model is None else frequency)
        if "specular" in given and frequency is not None:
            named = named._replace(diffuse=min(named.diffuse, 1.0 - given["specular"]))
        return named._replace(**given)

    @property
    def materials(self) -> tuple[Material, ...]:
        """The material itself."""
        return (self,)

    def indices(self, cells: Cells) -> Map:
        """Return row 0 for every cell."""
        return np.zeros(cells.shape, dtype=np.uint8)

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Return the fewest cells."""
        return fewest, fewest

    @property
    def layout(self) -> Material:
        """Any material."""
        return Material()

    def value_in_force(self, field: str, frequency: float | None = None) -> float | None:
        """Return the named material's number, fitted to its model at a frequency."""
        number: float | None = getattr(self.reflectivity_at(frequency), field)
        return number


class CompositeMap(MaterialMap):
    """A map of several materials; a kind declares its `indices`."""

    of: tuple[Material, ...] = parameter(description="materials of the map", min_length=2, max_length=32)

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials of the map."""
        return self.of

    @property
    def layout(self) -> CompositeMap:
        """The map without the scattering parameters of its materials, on which no border depends."""
        return self.model_copy(update={"of": (Material(),) * len(self.of)})


AnyMaterialMap = Annotated[MaterialMap, KindOf(MATERIAL_MAPS, default="uniform", text="uniform")]
