"""Autocorrelations that a correlation length sets."""

import math
from typing import Literal

import numpy as np

from insonify.scene.base import metres
from insonify.scene.seabed.autocorrelations import AutocorrelationKind
from insonify.scene.seabed.reliefs.spectrum import Density, Field


class LengthAutocorrelation(AutocorrelationKind):
    """Autocorrelation given by its correlation length."""

    length: float = metres(1.0, "lag at which the autocorrelation is 1/e", (0.2, 20.0), most=1e5)

    @property
    def feature(self) -> float:
        """Width of the narrowest feature of the spectrum, in cycles per metre."""
        return 1.0 / (2.0 * math.pi * self.length)

    def squared_phase(self, fx: Field, fy: Field) -> Field:
        """Squared product (k length)² of wave number and length, for waves in cycles per metre."""
        return np.asarray((2.0 * math.pi * self.length) ** 2 * (fx**2 + fy**2))


class ExponentialAutocorrelation(LengthAutocorrelation):
    """Exponential autocorrelation, exp(−lag / length)."""

    rank = 10
    kind: Literal["exponential"] = "exponential"

    def density(self, variance: float) -> Density:
        """Spectral density 2π h² l² (1 + k² l²)^−3/2."""
        return lambda fx, fy: np.asarray(
            variance * 2.0 * math.pi * self.length**2 * (1.0 + self.squared_phase(fx, fy)) ** -1.5
        )


class GaussianAutocorrelation(LengthAutocorrelation):
    """Gaussian autocorrelation, exp(−lag² / length²)."""

    rank = 20
    kind: Literal["gaussian"] = "gaussian"

    def density(self, variance: float) -> Density:
        """Spectral density π h² l² exp(−k² l²/4)."""
        return lambda fx, fy: np.asarray(
            variance * math.pi * self.length**2 * np.exp(-0.25 * self.squared_phase(fx, fy))
        )
