"""Volume and surface reverberation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.reverberations import ReverberationKind
from insonify.scene.receiver.reverberations.surface import surface_strength
from insonify.scene.receiver.reverberations.volume import volume_strength


class WholeReverberation(ReverberationKind):
    """Volume and surface reverberation."""

    rank = 40
    kind: Literal["both"] = "both"
    volume_strength: float = volume_strength()
    surface_strength: float = surface_strength()

    @property
    def of_volume(self) -> float:
        """Backscattering strength of a cubic metre of water, in dB."""
        return self.volume_strength

    @property
    def of_surface(self) -> float:
        """Backscattering strength of a square metre of the sea surface, in dB."""
        return self.surface_strength
