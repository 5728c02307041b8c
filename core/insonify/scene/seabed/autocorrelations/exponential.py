"""Exponential autocorrelation."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.seabed.autocorrelations import LengthAutocorrelation
from insonify.scene.seabed.reliefs.spectrum import Density


class ExponentialAutocorrelation(LengthAutocorrelation):
    """Exponential autocorrelation, exp(−lag / length)."""

    rank = 10
    kind: Literal["exponential"] = "exponential"

    def density(self, variance: float) -> Density:
        """Spectral density 2π h² l² (1 + k² l²)^−3/2."""
        return lambda fx, fy: np.asarray(
            variance * 2.0 * math.pi * self.length**2 * (1.0 + self.squared_phase(fx, fy)) ** -1.5
        )
