"""Reverberation of water and surface, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

REVERBERATIONS = Family("reverberations", "insonify.scene.receiver.reverberations")


class ReverberationKind(Choice):
    """Echoes of the water and its surface."""

    family = REVERBERATIONS

    @property
    def echoes(self) -> bool:
        """Whether the water or its surface echoes."""
        return self.of_volume is not None or self.of_surface is not None

    @property
    def of_volume(self) -> float | None:
        """Backscattering strength of a cubic metre of water, in dB; None where it does not echo."""
        return None

    @property
    def of_surface(self) -> float | None:
        """Backscattering strength of a square metre of the sea surface, in dB; None where it does not echo."""
        return None
