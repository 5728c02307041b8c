"""Masks that limit a relief to parts of the bed, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family
from insonify.scene.seabed.reliefs.spectrum import Density, Field

MASKS = Family("masks", "insonify.scene.seabed.masks")


class MaskKind(Choice):
    """Part of the bed that a relief covers; elsewhere the bed is level."""

    family = MASKS

    @property
    def coverage(self) -> float:
        """Share of the bed that the relief covers."""
        return 1.0

    @property
    def spread(self) -> float | None:
        """Spread of the spectrum of the field that the mask is cut from, cycles a metre; None if it masks nothing."""
        return None

    def density(self, narrowest: float = 0.0) -> Density:
        """Spectral density of that field, of unit variance and at least so wide (cycles a metre)."""
        raise NotImplementedError

    def weigh(self, field: Field, threshold: float) -> Field:
        """Weight of the relief, 0 to 1, from a field of unit variance and its value on the borders."""
        raise NotImplementedError
