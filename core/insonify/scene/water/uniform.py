"""Water of one sound speed."""

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.water import SoundSpeeds, WaterKind, speeds_by_depth


class UniformWater(WaterKind):
    """Still water of one sound speed."""

    rank = 10
    kind: Literal["uniform"] = "uniform"
    sound_speed: float = parameter(1500.0, "speed of sound", "m/s", ge=1300.0, le=1700.0, slider=(1400.0, 1600.0))

    @property
    def only_speed(self) -> float:
        """Speed of sound, in m/s."""
        return self.sound_speed

    def sound_speeds(self) -> SoundSpeeds:
        """Return one speed for every depth."""
        return speeds_by_depth([0.0], [self.sound_speed])
