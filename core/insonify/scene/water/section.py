"""Water that differs from place to place."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from insonify.scene.base import parameter
from insonify.scene.water import SoundSpeeds
from insonify.scene.water.layered import (
    SPEEDS,
    LayeredWater,
    Speed,
    check_length,
    check_order,
)


class SectionWater(LayeredWater):
    """Water that differs from place to place: profiles along a level line through the scene's (0, 0)."""

    table: ClassVar[frozenset[str]] = frozenset({"distance", "depth", "sound_speed"})
    rank = 50
    varies_along = True
    kind: Literal["section"] = "section"
    distance: tuple[Annotated[float, Field(ge=-1e6, le=1e6)], ...] = parameter(
        (0.0, 200.0), unit="m", description="places of the profiles along the line", slider=(-100.0, 100.0)
    )
    sound_speed: tuple[tuple[Speed, ...], ...] = parameter(
        (SPEEDS, (1520.0, 1520.0, 1515.0, 1500.0)),
        unit="m/s",
        description="speed of sound at every distance, one list of the depths each",
        slider=(1400.0, 1600.0),
    )
    heading: float = parameter(
        0.0,
        unit="°",
        description="direction of the line, counter-clockwise from +x",
        ge=-360.0,
        le=360.0,
        slider=(-180.0, 180.0),
    )

    @field_validator("distance")
    @classmethod
    def _goes_onwards(cls, distance: tuple[float, ...]) -> tuple[float, ...]:
        check_order("distance", distance, "water that is the same everywhere is kind 'profile'")
        return distance

    @model_validator(mode="after")
    def _a_profile_each(self) -> SectionWater:
        if len(self.sound_speed) != len(self.distance):
            raise ValueError(
                f"sound_speed has {len(self.sound_speed)} profiles for {len(self.distance)} distances; give one each"
            )
        for number, profile in enumerate(self.sound_speed):
            check_length(f"sound_speed.{number}", len(profile), self.depth)
        return self

    def sound_speeds(self) -> SoundSpeeds:
        """Speeds of the profiles along the line."""
        return SoundSpeeds(
            np.array(self.depth), np.array(self.sound_speed), np.array(self.distance), math.radians(self.heading)
        )
