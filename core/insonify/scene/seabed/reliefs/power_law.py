"""Roughness by a power law."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief
from insonify.scene.seabed.reliefs.spectrum import Band, Density, Field

REFERENCE_LENGTH = 0.01  # m, h₀


class PowerLaw(ExtendableRelief):
    """Roughness W(K) = w₂ (h₀K)^−γ₂ with h₀ = 1 cm, as measured over sediments (APL-UW TR 9407, II.A)."""

    rank = 30
    levels_off = True
    kind: Literal["power_law"] = "power_law"
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

        def density(fx: Field, fy: Field) -> Field:
            squared = (2.0 * math.pi) ** 2 * (fx**2 + fy**2) + clamp
            # The mean height is no roughness.
            scaled = np.where(squared > 0.0, squared * REFERENCE_LENGTH**2, np.inf)
            return np.asarray(4.0 * math.pi**2 * strength * scaled ** (-0.5 * self.exponent))

        return density

    def bands(self) -> tuple[Band, ...]:
        """Return one band, constant at waves longer than the period."""
        return (Band(self.density(self.period), 1.0 / self.period),)
