"""Time-varied gains, one file a kind."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

GAINS = Family("gains", "insonify.scene.gains")


class GainKind(Choice):
    """Time-varied gain."""

    family = GAINS

    def decibels(self, slant_range: NDArray[np.float64], absorption: float) -> NDArray[np.float64]:
        """Gain in dB at slant ranges (m), in water of that absorption (Np/m)."""
        del absorption
        return np.zeros(slant_range.shape)
