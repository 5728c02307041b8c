"""Volume reverberation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.reverberations import ReverberationKind


def volume_strength() -> float:
    """Declare the backscattering strength of the water."""
    return parameter(
        -70.0,
        unit="dB",
        description="backscattering strength of a cubic metre of water",
        ge=-200.0,
        le=0.0,
        slider=(-100.0, -40.0),
    )


class VolumeReverberation(ReverberationKind):
    """Volume reverberation: the water echoes."""

    rank = 20
    kind: Literal["volume"] = "volume"
    volume_strength: float = volume_strength()

    @property
    def of_volume(self) -> float:
        """Backscattering strength of a cubic metre of water, in dB."""
        return self.volume_strength
