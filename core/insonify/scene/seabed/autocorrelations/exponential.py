"""Exponential autocorrelation."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.seabed.autocorrelations import AutocorrelationKind, squared_phase
from insonify.scene.seabed.reliefs.spectrum import Density


class ExponentialAutocorrelation(AutocorrelationKind):
    """Exponential autocorrelation, exp(−lag / length)."""

    rank = 10
    kind: Literal["exponential"] = "exponential"
    length: float = parameter(
        1.0, unit="m", description="lag at which 1/e is left", gt=0.0, le=1e5, slider=(0.2, 20.0), log=True
    )

    @property
    def feature(self) -> float:
        """Frequency over which the spectrum changes, from how far the autocorrelation reaches."""
        return 1.0 / (2.0 * math.pi * self.length)

    def density(self, variance: float) -> Density:
        """Spectral density 2π h² l² (1 + k² l²)^−3/2."""
        return lambda fx, fy: np.asarray(
            variance * 2.0 * math.pi * self.length**2 * (1.0 + squared_phase(fx, fy, self.length)) ** -1.5
        )
