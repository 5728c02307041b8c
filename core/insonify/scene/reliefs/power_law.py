"""Roughness by a power law."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.reliefs.random_relief import ExtendableRelief


class PowerLaw(ExtendableRelief):
    """Roughness W(K) = w₂ (h₀K)^−γ₂ with h₀ = 1 cm, as measured over sediments (APL-UW TR 9407, II.A)."""

    rank = 30
    kind: Literal["power_law"] = "power_law"
    strength: float = parameter(
        0.0044,
        unit="cm⁴",
        description="spectral strength w₂ (fine sand 0.003, medium sand 0.0044, sandy gravel 0.013)",
        ge=0.0,
        le=100.0,
        slider=(1e-4, 0.1),
        log=True,
    )
    exponent: float = parameter(3.25, description="spectral exponent γ₂", gt=2.0, lt=4.0, slider=(2.4, 3.9))
