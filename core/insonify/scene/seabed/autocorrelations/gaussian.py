"""Gaussian autocorrelation."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.seabed.autocorrelations import LengthAutocorrelation
from insonify.scene.seabed.reliefs.spectrum import Density


class GaussianAutocorrelation(LengthAutocorrelation):
    """Gaussian autocorrelation, exp(−lag² / length²)."""

    rank = 20
    kind: Literal["gaussian"] = "gaussian"

    def density(self, variance: float) -> Density:
        """Spectral density π h² l² exp(−k² l²/4)."""
        return lambda fx, fy: np.asarray(
            variance * math.pi * self.length**2 * np.exp(-0.25 * self.squared_phase(fx, fy))
        )
