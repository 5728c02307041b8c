"""Gaussian autocorrelation."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.seabed.autocorrelations import AutocorrelationKind, squared_phase
from insonify.scene.seabed.reliefs.spectrum import Density


class GaussianAutocorrelation(AutocorrelationKind):
    """Gaussian autocorrelation, exp(−lag² / length²)."""

    rank = 20
    kind: Literal["gaussian"] = "gaussian"
    length: float = parameter(
        1.0, unit="m", description="lag at which 1/e is left", gt=0.0, le=1e5, slider=(0.2, 20.0), log=True
    )

    @property
    def feature(self) -> float:
        """Frequency over which the spectrum changes, from how far the autocorrelation reaches."""
        return 1.0 / (2.0 * math.pi * self.length)

    def density(self, variance: float) -> Density:
        """Spectral density π h² l² exp(−k² l²/4)."""
        return lambda fx, fy: np.asarray(
            variance * math.pi * self.length**2 * np.exp(-0.25 * squared_phase(fx, fy, self.length))
        )
