"""A sea raised by the wind."""

from __future__ import annotations

import math
from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.water.surfaces.mirror import MirrorSurface

GRAVITY = 9.81  # m/s²
# Pierson and Moskowitz (1964): S(ω) = α g² ω⁻⁵ exp(−β (g / Uω)⁴).
ALPHA, BETA = 8.1e-3, 0.74
# Wave number at which ripples of surface tension take over (1.7 cm long), rad/m: facets no finer are counted.
FINEST = 363.0
CALM = 0.02  # m/s, of a wind whose waves are all finer: E₁(3000) is nothing


class RoughSurface(MirrorSurface):
    """A sea raised by the wind: multipath keeps its energy and is smeared in range."""

    rank = 30
    kind: Literal["rough"] = "rough"
    wind_speed: float = parameter(
        5.0,
        unit="m/s",
        description="wind that has raised the sea, 19.5 m above it",
        ge=0.0,
        le=30.0,
        slider=(0.0, 15.0),
    )

    @property
    def rms_height(self) -> float:
        """Rms height of the waves that the wind has raised, in metres."""
        return rms_height(self.wind_speed)

    @property
    def slope_variance(self) -> float:
        """Variance of the slope of the waves along one direction."""
        return slope_variance(self.wind_speed)


def rms_height(wind_speed: float) -> float:
    """Rms height of the waves, in metres, for a wind in m/s: h² = ∫ S dω = α U⁴ / (4 β g²)."""
    return math.sqrt(ALPHA / (4.0 * BETA)) * wind_speed**2 / GRAVITY


def slope_variance(wind_speed: float) -> float:
    """Variance of the slope of the waves in one direction, half of that in both, for a wind in m/s.

    ∫ (ω²/g)² S dω up to the finest wave, ω² = g · 363 rad/m, is α/4 · E₁(β (g / Uω)⁴); with U = 5 m/s it is 0.027 in
    both directions, where Cox and Munk (1954) measured 0.003 + 0.00512 U = 0.029.
    """
    from scipy import special  # takes longer to import than a scene to read

    if wind_speed < CALM:
        return 0.0
    squared = GRAVITY / (wind_speed**2 * FINEST)  # (g / Uω)²
    return float(0.5 * ALPHA / 4.0 * special.exp1(BETA * squared**2))
