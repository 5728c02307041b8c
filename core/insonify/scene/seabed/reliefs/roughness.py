"""Roughness by its spectral density or its autocorrelation."""

import math
from typing import Annotated

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import KindOf, angle, metres, parameter
from insonify.scene.seabed.autocorrelations import AUTOCORRELATIONS, AutocorrelationKind, ExponentialAutocorrelation
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, rms_height
from insonify.scene.seabed.reliefs.spectrum import Band, Density, rotate_frequencies

REFERENCE_LENGTH = 0.01  # m, h₀


class PowerLaw(ExtendableRelief, kind="power_law", rank=30):
    """Roughness W(K) = w₂ (h₀K)^−γ₂ with h₀ = 1 cm, as measured over sediments (APL-UW TR 9407, II.A)."""

    levels_off = True
    strength: float = parameter(
        0.0044,
        "spectral strength w₂ (fine sand 0.003, medium sand 0.0044, sandy gravel 0.013)",
        "cm⁴",
        ge=0.0,
        le=100.0,
        slider=(1e-4, 0.1),
        log=True,
    )
    exponent: float = parameter(3.25, "spectral exponent γ₂", gt=2.0, lt=4.0, slider=(2.4, 3.9))

    def density(self, outer: float | None = None) -> Density:
        """W(K) = w₂ (h₀K)^−γ₂; it levels off at waves as long as the outer scale (m) if one is given."""
        strength = self.strength * REFERENCE_LENGTH**4
        clamp = 0.0 if outer is None else (2.0 * math.pi / outer) ** 2

        def density(fx: Floats, fy: Floats) -> Floats:
            squared = (2.0 * math.pi) ** 2 * (fx**2 + fy**2) + clamp
            # The mean height is no roughness.
            scaled = np.where(squared > 0.0, squared * REFERENCE_LENGTH**2, np.inf)
            return np.asarray(4.0 * math.pi**2 * strength * scaled ** (-0.5 * self.exponent))

        return density

    def bands(self) -> tuple[Band, ...]:
        """Return one band, constant at waves longer than the period."""
        return (Band(self.density(self.period), 1.0 / self.period),)


class VonKarman(ExtendableRelief, kind="von_karman", rank=40):
    """Lineated roughness that levels off at long waves (Goff and Jordan 1988)."""

    rms: float = rms_height()
    across: float = metres(
        5.0, "wavelength across the crests beyond which the spectrum levels off, 2π/k_n", (0.5, 100.0), most=1e6
    )
    along: float = metres(
        15.0, "wavelength along the crests beyond which the spectrum levels off, 2π/k_s", (0.5, 100.0), most=1e6
    )
    heading: float = angle("direction along the crests, counter-clockwise from east; 45T is 45° by the compass")
    hurst: float = parameter(0.8, "exponent ν; the fractal dimension is 3 − ν", gt=0.0, le=3.0, slider=(0.1, 1.0))

    def density(self) -> Density:
        """P = 4πν h²/(k_n k_s) (1 + u²)^−(ν+1), u² = (k across/k_n)² + (k along/k_s)²: Goff and Jordan 1988, eq. 4."""
        across, along = self.across / (2.0 * math.pi), self.along / (2.0 * math.pi)
        level = 4.0 * math.pi * self.hurst * self.rms**2 * across * along

        def density(fx: Floats, fy: Floats) -> Floats:
            f_along, f_across = rotate_frequencies(fx, fy, self.heading)
            squared = (2.0 * math.pi) ** 2 * ((f_across * across) ** 2 + (f_along * along) ** 2)
            return np.asarray(level * (1.0 + squared) ** -(self.hurst + 1.0))

        return density

    def bands(self) -> tuple[Band, ...]:
        """Return one band; its finest feature is the frequency at which it levels off."""
        return (Band(self.density(), 1.0 / max(self.across, self.along)),)


class Autocorrelated(ExtendableRelief, kind="autocorrelation", rank=70):
    """Isotropic roughness of a given autocorrelation (Wiener–Khinchin)."""

    gaussian = False
    rms: float = rms_height()
    function: Annotated[AutocorrelationKind, KindOf(AUTOCORRELATIONS, default="exponential")] = parameter(
        ExponentialAutocorrelation, "autocorrelation of the heights over the lag"
    )

    def density(self) -> Density:
        """Spectral density by the transform of the autocorrelation."""
        return self.function.density(self.rms**2)

    def bands(self) -> tuple[Band, ...]:
        """Return one band."""
        return (Band(self.density(), self.function.feature),)
