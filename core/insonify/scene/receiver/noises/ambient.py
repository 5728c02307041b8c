"""Ambient noise."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.noises import NoiseKind


class AmbientNoise(NoiseKind):
    """Noise of the sea and the receiver: a Gaussian wave, of exponential intensity where there is no echo."""

    rank = 20
    kind: Literal["ambient"] = "ambient"
    level: float = parameter(
        -110.0,
        unit="dB",
        description="mean level in the receiver's band, dB re the source at 1 m, or re 1 µPa with a source level",
        ge=-300.0,
        le=200.0,
        slider=(-150.0, 120.0),
    )

    @property
    def mean_level(self) -> float:
        """Mean level, in dB."""
        return self.level
