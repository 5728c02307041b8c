"""The sea surface, a mirror that is flat or raised by the wind."""

import math
from collections.abc import Iterator
from typing import ClassVar

from insonify.scene.base import Family, Kind, describe_excess, parameter

SURFACES = Family("surfaces", "insonify.scene.water")
WAYS = ("surface_bottom", "surface_bottom_surface", "second_bottom", "surface_echo")
# Pierson and Moskowitz (1964): S(ω) = α g² ω⁻⁵ exp(−β (g / Uω)⁴).
ALPHA, BETA = 8.1e-3, 0.74
# Greatest wave number of the slopes, in rad/m: that of the shortest gravity waves (1.7 cm).
FINEST = 363.0
STRONGEST = 15.0  # m/s, wind beyond which waves break and bubbles take over
CALM = 0.02  # m/s, wind below which all waves are finer than that: E₁(3000) underflows


class SurfaceKind(Kind):
    """The sea surface."""

    family = SURFACES
    reflects: ClassVar[bool] = False  # whether it reflects sound

    @property
    def paths(self) -> tuple[bool, ...]:
        """Whether each multipath by the surface is modelled, in the order of `WAYS`."""
        return tuple(getattr(self, way, False) for way in WAYS)

    @property
    def rms_height(self) -> float:
        """Rms height of the waves, in metres."""
        return 0.0

    @property
    def slope_variance(self) -> float:
        """Variance of the slope of the waves along one direction."""
        return 0.0


class NoSurface(SurfaceKind, kind="none", rank=10):
    """No sea surface: the water has no upper end."""


class MirrorSurface(SurfaceKind):
    """A sea surface that reflects all sound; each path by it can be switched off."""

    reflects = True
    surface_bottom: bool = parameter(True, "paths by the surface one way and direct the other way")
    surface_bottom_surface: bool = parameter(True, "paths by the surface both ways")
    second_bottom: bool = parameter(
        True, "paths by the bed beneath the sonar and then the surface one way, direct the other way"
    )
    surface_echo: bool = parameter(True, "the echo of the surface straight above the sonar")


class FlatSurface(MirrorSurface, kind="flat", rank=20):
    """A calm sea, which mirrors perfectly."""


class RoughSurface(MirrorSurface, kind="rough", rank=30):
    """A sea raised by the wind: multipath keeps its energy and is spread in range."""

    wind_speed: float = parameter(
        5.0, "speed of the wind that raises the sea, 19.5 m above it", "m/s", ge=0.0, le=30.0, slider=(0.0, 15.0)
    )
    gravity: float = parameter(
        9.81, "gravity, which holds the waves down", "m/s²", ge=0.1, le=100.0, slider=(1.0, 25.0), rare=True
    )

    @property
    def rms_height(self) -> float:
        """Rms height of the waves, in metres: h² = ∫ S dω = α U⁴ / (4 β g²)."""
        return math.sqrt(ALPHA / (4.0 * BETA)) * self.wind_speed**2 / self.gravity

    @property
    def slope_variance(self) -> float:
        """Variance of the slope of the waves along one direction, half of that in both."""
        # ∫ (ω²/g)² S dω up to the finest wave, ω² = g · 363 rad/m, is α/4 · E₁(β (g / Uω)⁴); with U = 5 m/s it is 0.027
        # in both directions, where Cox and Munk (1954) measured 0.003 + 0.00512 U = 0.029.
        from scipy import special  # lazy: SciPy takes longer to import than a scene to read

        if self.wind_speed < CALM:
            return 0.0
        squared = self.gravity / (self.wind_speed**2 * FINEST)  # (g / Uω)²
        return float(0.5 * ALPHA / 4.0 * special.exp1(BETA * squared**2))

    def describe_limits(self, frequency: float) -> Iterator[str]:
        """Describe a wind in which breaking waves and bubbles take the place of facets."""
        formula = "a surface of mirror facets"
        yield from describe_excess("wind", self.wind_speed, self.wind_speed, " m/s", (0.0, STRONGEST), formula)
