"""Water of given temperature and salinity."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from insonify.scene.base import parameter
from insonify.scene.waters.layered import (
    Equation,
    LayeredWater,
    check_length,
)

Temperature = Annotated[float, Field(ge=-2.0, le=40.0)]


Salinity = Annotated[float, Field(ge=0.0, le=45.0)]


class HydrographyWater(LayeredWater):
    """Water of given temperature and salinity, straight between the depths; the speed follows from an equation."""

    table: ClassVar[frozenset[str]] = frozenset({"depth", "temperature", "salinity"})
    rank = 30
    kind: Literal["hydrography"] = "hydrography"
    temperature: tuple[Temperature, ...] = parameter(
        (18.0, 17.6, 11.6, 11.0), unit="°C", description="temperature at those depths", slider=(0.0, 30.0)
    )
    salinity: Salinity | tuple[Salinity, ...] = parameter(
        35.0, description="practical salinity at those depths, or one number for all", slider=(0.0, 40.0)
    )
    equation: Equation = parameter("teos10", description="how the speed of sound follows from them")

    @model_validator(mode="after")
    def _one_of_each(self) -> HydrographyWater:
        check_length("temperature", len(self.temperature), self.depth)
        if isinstance(self.salinity, tuple):
            check_length("salinity", len(self.salinity), self.depth)
        return self
