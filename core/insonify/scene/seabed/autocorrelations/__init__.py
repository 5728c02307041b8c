"""Autocorrelations of heights: their base class."""

from abc import abstractmethod

from insonify.scene.base import Family, Kind
from insonify.scene.seabed.reliefs.spectrum import Density

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
        """Spectral density of heights of that variance (m²): P(k) = h² 2π ∫ ρ(r) J₀(kr) r dr (Wiener–Khinchin)."""
