"""Autocorrelations of heights, one file a kind."""

from __future__ import annotations

import math
from abc import abstractmethod

import numpy as np

from insonify.scene.base import Choice
from insonify.scene.kinds import Family
from insonify.scene.seabed.reliefs.spectrum import Density, Field

AUTOCORRELATIONS = Family("autocorrelations", "insonify.scene.seabed.autocorrelations")


class AutocorrelationKind(Choice):
    """Autocorrelation of heights over the lag."""

    family = AUTOCORRELATIONS

    @property
    @abstractmethod
    def feature(self) -> float:
        """Width of the finest feature of the spectrum, in cycles per metre."""

    @abstractmethod
    def density(self, variance: float) -> Density:
        """Spectral density of heights of that variance (m²): P(k) = h² 2π ∫ ρ(r) J₀(kr) r dr (Wiener–Khinchin).

        Raises
        ------
        SceneError
            If no surface has that autocorrelation, or its file cannot be read.
        """


def squared_phase(fx: Field, fy: Field, length: float) -> Field:
    """Squared product (k length)² of wave number and length, for waves in cycles per metre."""
    return np.asarray((2.0 * math.pi * length) ** 2 * (fx**2 + fy**2))
