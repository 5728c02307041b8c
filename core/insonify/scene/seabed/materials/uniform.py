"""One material."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import field_validator, model_validator

from insonify.scene.base import parameter
from insonify.scene.seabed.materials.base import Cells, Map, MaterialMap
from insonify.scene.seabed.materials.catalogue import MATERIALS
from insonify.scene.seabed.materials.reflectivity import Reflectivity, refuse_excess


class Material(MaterialMap):
    """One material: a name, or numbers that override the name's."""

    rank = 1
    kind: Literal["uniform"] = "uniform"
    name: str = parameter("medium_sand", description="named material whose numbers apply where none are given")
    diffuse: float | None = parameter(
        None, description="share of energy scattered evenly (Lambert)", ge=0.0, le=1.0, slider=(0.0, 1.0)
    )
    specular: float | None = parameter(
        None, description="share of energy in the mirror lobe (Phong)", ge=0.0, le=1.0, slider=(0.0, 1.0)
    )
    shininess: float | None = parameter(
        None,
        description="exponent n of the mirror lobe, as of facets with an rms slope of 1/(2√n) each way",
        ge=1.0,
        le=1000.0,
        slider=(1.0, 200.0),
        log=True,
    )
    reflection: float | None = parameter(
        None,
        description="share of the amplitude reflected specularly at normal incidence (R0)",
        ge=0.0,
        le=1.0,
        slider=(0.0, 1.0),
    )
    speed_ratio: float | None = parameter(
        None, description="speed of sound inside over that of water", ge=0.1, le=10.0, slider=(0.5, 5.0), log=True
    )
    speckle_shape: float | None = parameter(
        None,
        description="shape of K speckle on this material; fewer scatterers make it smaller and the speckle spikier",
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
    def _no_more_than_arrives(self) -> Material:
        refuse_excess(*self.reflectivity[:2])
        return self

    @property
    def reflectivity(self) -> Reflectivity:
        """Scattering parameters in force: the given ones, else the named material's."""
        given = {field: getattr(self, field) for field in Reflectivity._fields}
        named = MATERIALS[self.name].reflectivity
        return named._replace(**{field: number for field, number in given.items() if number is not None})

    @property
    def materials(self) -> tuple[Material, ...]:
        """The material itself."""
        return (self,)

    def indices(self, cells: Cells) -> Map:
        """Return the first row for every cell."""
        return np.zeros(cells.shape, dtype=np.uint8)

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Return the fewest cells."""
        return fewest, fewest

    @property
    def layout(self) -> Material:
        """Any material."""
        return Material()

    def value_in_force(self, field: str) -> float | None:
        """Return the named material's number."""
        number: float | None = getattr(self.reflectivity, field)
        return number
