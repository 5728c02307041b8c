"""Water of given temperature and salinity."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from insonify.scene.base import parameter
from insonify.scene.water import SoundSpeeds, Values, speeds_by_depth
from insonify.scene.water.layered import Equation, LayeredWater, check_length
from insonify.scene.water.polyline import CURVE_TOLERANCE, approximate_by_segments
from insonify.scene.water.sound_speed import EQUATIONS

Temperature = Annotated[float, Field(ge=-2.0, le=40.0)]
Salinity = Annotated[float, Field(ge=0.0, le=45.0)]


class HydrographyWater(LayeredWater):
    """Water of given temperature and salinity, linear between the depths; the speed follows from an equation."""

    table: ClassVar[frozenset[str]] = frozenset({"depth", "temperature", "salinity"})
    rank = 30
    kind: Literal["hydrography"] = "hydrography"
    temperature: tuple[Temperature, ...] = parameter(
        (18.0, 17.6, 11.6, 11.0), "temperature at those depths", "°C", slider=(0.0, 30.0)
    )
    salinity: Salinity | tuple[Salinity, ...] = parameter(
        35.0, "practical salinity at those depths, or one number for all", slider=(0.0, 40.0)
    )
    equation: Equation = parameter("teos10", "equation of sound speed", rare=True)

    @model_validator(mode="after")
    def _one_value_a_depth(self) -> HydrographyWater:
        check_length("temperature", len(self.temperature), self.depth)
        if isinstance(self.salinity, tuple):
            check_length("salinity", len(self.salinity), self.depth)
        return self

    def sound_speeds(self) -> SoundSpeeds:
        """Speed by the equation from temperature and salinity that are linear between the depths."""
        depth = np.array(self.depth)
        salinity = np.broadcast_to(np.asarray(self.salinity, dtype=np.float64), depth.shape)

        def speed(places: Values) -> Values:
            temperature = np.interp(places, depth, np.array(self.temperature))
            return EQUATIONS[self.equation](temperature, np.interp(places, depth, salinity), places)

        return speeds_by_depth(*approximate_by_segments(speed, depth, CURVE_TOLERANCE))
