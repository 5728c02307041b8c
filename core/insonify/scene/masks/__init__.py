"""Masks of a relief, one file a kind: where on the bed it is."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family
from insonify.scene.reliefs.spectrum import Density, Field

MASKS = Family("masks", "insonify.scene.masks")


class MaskKind(Choice):
    """Where a relief is, of a bed that is level elsewhere."""

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
        """Share of the relief that is left, from a field of unit variance and its value on the borders."""
        raise NotImplementedError
