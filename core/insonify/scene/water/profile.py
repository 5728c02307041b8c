"""Water of given sound speeds."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.scene.water import SoundSpeeds, speeds_by_depth
from insonify.scene.water.layered import SPEEDS, Interpolation, LayeredWater, Speed, check_length, interpolation
from insonify.scene.water.polyline import CURVE_TOLERANCE, approximate_pchip


class ProfileWater(LayeredWater):
    """Water of given speeds at given depths."""

    table: ClassVar[frozenset[str]] = frozenset({"depth", "sound_speed"})
    rank = 20
    kind: Literal["profile"] = "profile"
    sound_speed: tuple[Speed, ...] = parameter(SPEEDS, "speed of sound at those depths", "m/s", slider=(1400.0, 1600.0))
    interpolation: Interpolation = interpolation()

    @model_validator(mode="after")
    def _one_speed_a_depth(self) -> ProfileWater:
        check_length("sound_speed", len(self.sound_speed), self.depth)
        return self

    def sound_speeds(self) -> SoundSpeeds:
        """Speed between the depths, linear or along a curve."""
        if self.interpolation == "linear":
            return speeds_by_depth(self.depth, self.sound_speed)
        return speeds_by_depth(*approximate_pchip(np.array(self.depth), np.array(self.sound_speed), CURVE_TOLERANCE))
