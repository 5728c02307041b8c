"""Autocorrelations of heights, one file a kind."""

from __future__ import annotations

import math
from abc import abstractmethod

import numpy as np

from insonify.scene.base import Family, Kind, length
from insonify.scene.seabed.reliefs.spectrum import Density, Field

AUTOCORRELATIONS = Family("autocorrelations", "insonify.scene.seabed.autocorrelations")


class AutocorrelationKind(Kind):
    """Autocorrelation of heights over the lag."""

    family = AUTOCORRELATIONS

    @property
    @abstractmethod
    def feature(self) -> float:
        """Width of the narrowest feature of the spectrum, in cycles per metre."""

    @abstractmethod
    def density(self, variance: float) -> Density:
        """Spectral density of heights of that variance (m²): P(k) = h² 2π ∫ ρ(r) J₀(kr) r dr (Wiener–Khinchin).

        Raises
        ------
        SceneError
            If no surface can have that autocorrelation, or its file cannot be read.
        """


class LengthAutocorrelation(AutocorrelationKind):
    """Autocorrelation given by its correlation length."""

    length: float = length(1.0, "lag at which the autocorrelation is 1/e", (0.2, 20.0), most=1e5)

    @property
    def feature(self) -> float:
        """Width of the narrowest feature of the spectrum, in cycles per metre."""
        return 1.0 / (2.0 * math.pi * self.length)

    def squared_phase(self, fx: Field, fy: Field) -> Field:
        """Squared product (k length)² of wave number and length, for waves in cycles per metre."""
        return np.asarray((2.0 * math.pi * self.length) ** 2 * (fx**2 + fy**2))
