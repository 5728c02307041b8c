"""Roughness by its autocorrelation."""

from __future__ import annotations

from typing import Annotated, Literal

from insonify.scene.base import KindOf, parameter
from insonify.scene.seabed.autocorrelations import AUTOCORRELATIONS, AutocorrelationKind
from insonify.scene.seabed.autocorrelations.by_length import ExponentialAutocorrelation
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, rms_height
from insonify.scene.seabed.reliefs.spectrum import Band, Density


class Autocorrelated(ExtendableRelief):
    """Isotropic roughness of a given autocorrelation (Wiener–Khinchin)."""

    rank = 70
    gaussian = False
    kind: Literal["autocorrelation"] = "autocorrelation"
    rms: float = rms_height()
    function: Annotated[AutocorrelationKind, KindOf(AUTOCORRELATIONS, default="exponential")] = parameter(
        ExponentialAutocorrelation(), "autocorrelation of the heights over the lag"
    )

    def density(self) -> Density:
        """Spectral density by the transform of the autocorrelation."""
        return self.function.density(self.rms**2)

    def bands(self) -> tuple[Band, ...]:
        """Return one band."""
        return (Band(self.density(), self.function.feature),)
