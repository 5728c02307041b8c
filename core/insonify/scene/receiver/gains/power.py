"""Gain by a power of range."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import parameter
from insonify.scene.receiver.gains import GainKind, RangeBins
from insonify.scene.water.absorptions import NEPER_PER_DB


class PowerTvg(GainKind):
    """Time-varied gain by a power of range and by absorption: spreading · log r + 2αr, clipped at the noise floor."""

    rank = 20
    kind: Literal["power"] = "power"
    spreading: float = parameter(
        30.0,
        unit="dB",
        description="gain per tenfold slant range: 40 for points, 30 for beds, 20 for volumes",
        ge=0.0,
        le=80.0,
        slider=(0.0, 60.0),
    )
    absorption: float | None = parameter(
        None,
        unit="dB/km",
        description="absorption made good on the way there and back (the water's own when left out)",
        ge=0.0,
        le=1e4,
        slider=(0.0, 400.0),
    )

    def decibels(self, bins: RangeBins, absorption: float) -> NDArray[np.float64]:
        """Gain in dB, spreading · log₁₀ r + 2αr with α in dB/m."""
        loss = absorption if self.absorption is None else self.absorption * NEPER_PER_DB / 1e3
        return self.spreading * np.log10(bins.slant_range) + 2.0 * loss / NEPER_PER_DB * bins.slant_range
