"""Absorption formulas, one file a kind."""

from __future__ import annotations

import math
from typing import ClassVar

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

ABSORPTIONS = Family("absorptions", "insonify.scene.water.absorptions")
NEPER_PER_DB = math.log(10.0) / 20.0


class AbsorptionKind(Choice):
    """Absorption of sound by the water.

    Attributes
    ----------
    by_frequency : bool
        Whether the frequency changes it.
    """

    family = ABSORPTIONS
    by_frequency: ClassVar[bool] = True

    def decibels_per_km(self, frequency: float, depth: float) -> float:
        """Absorption one way, in dB/km, of sound of a frequency in Hz at a depth in metres."""
        del frequency, depth
        return 0.0
