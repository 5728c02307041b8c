"""Autocorrelations of heights, one file a kind."""

from __future__ import annotations

import math

import numpy as np

from insonify.scene.base import Choice
from insonify.scene.kinds import Family
from insonify.scene.reliefs.spectrum import Density, Field

AUTOCORRELATIONS = Family("autocorrelations", "insonify.scene.autocorrelations")


class AutocorrelationKind(Choice):
    """Autocorrelation of heights over the lag."""

    family = AUTOCORRELATIONS

    @property
    def feature(self) -> float:
        """Frequency over which the spectrum changes at its finest, cycles a metre."""
        raise NotImplementedError

    def density(self, variance: float) -> Density:
        """Spectral density of heights of that variance (m²): P(k) = h² 2π ∫ ρ(r) J₀(kr) r dr (Wiener–Khinchin).

        Raises
        ------
        SceneError
            If no surface has that autocorrelation, or its file cannot be read.
        """
        raise NotImplementedError


def squared_phase(fx: Field, fy: Field, length: float) -> Field:
    """(k length)² of waves in cycles a metre."""
    return np.asarray((2.0 * math.pi * length) ** 2 * (fx**2 + fy**2))
