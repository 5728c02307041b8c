"""Water that varies horizontally."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from insonify.scene.base import angle, parameter
from insonify.scene.water import SoundSpeeds
from insonify.scene.water.layered import SPEEDS, LayeredWater, Speed, check_length, check_order


class SectionWater(LayeredWater):
    """Water that varies horizontally: sound speed profiles along a line through the scene's (0, 0)."""

    table: ClassVar[frozenset[str]] = frozenset({"distance", "depth", "sound_speed"})
    rank = 50
    varies_along = True
    kind: Literal["section"] = "section"
    distance: tuple[Annotated[float, Field(ge=-1e6, le=1e6)], ...] = parameter(
        (0.0, 200.0), "places of the profiles along the line", "m", slider=(-100.0, 100.0)
    )
    sound_speed: tuple[tuple[Speed, ...], ...] = parameter(
        (SPEEDS, (1520.0, 1520.0, 1515.0, 1500.0)),
        "speed of sound: for every distance, a list over the depths",
        "m/s",
        slider=(1400.0, 1600.0),
    )
    heading: float = angle("direction of the line, counter-clockwise from +x")

    @field_validator("distance")
    @classmethod
    def _goes_onwards(cls, distance: tuple[float, ...]) -> tuple[float, ...]:
        check_order("distance", distance, "for horizontally uniform water use kind 'profile'")
        return distance

    @model_validator(mode="after")
    def _one_profile_a_distance(self) -> SectionWater:
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
