"""Reflectivity of a surface: diffuse and specular shares, lobe, and impedance of the interface."""

from __future__ import annotations

import math
from typing import NamedTuple


class Reflectivity(NamedTuple):
    """Scattering parameters of a surface."""

    # Shares of the energy that returns evenly (Lambert) and in a lobe about the mirror direction (Phong).
    diffuse: float
    specular: float
    shininess: float  # exponent of that lobe
    reflection: float = 0.0  # R0, share of the amplitude that a smooth surface reflects at normal incidence
    speed_ratio: float = 1.0  # ν, speed of sound inside over that of water
    speckle_shape: float | None = None  # shape of K speckle; the receiver's own where None

    @property
    def lobe_half_width(self) -> float:
        """Incidence at which the lobe is half as strong as straight on, in degrees.

        Sound that returns the way it came is 2α off the mirror direction at incidence α, so that cosⁿ(2α) = ½ at
        α = ½ arccos 2^(−1/n): half of what the exponent n means to light and eye.
        """
        return math.degrees(0.5 * math.acos(2.0 ** (-1.0 / self.shininess)))

    @property
    def facet_slope(self) -> float:
        """Rms slope, along one horizontal axis, of the microstructure that makes such a lobe.

        A surface of mirror-like facets with Gaussian slopes of that rms s returns in proportion to the share of them
        that faces the sonar, exp(−tan² α / 2s²) (Kirchhoff approximation, high frequencies); near the middle
        cosⁿ(2α) ≈ exp(−2nα²), so that s = 1/(2√n).
        """
        return 0.5 / math.sqrt(self.shininess)


def refuse_excess(diffuse: float, specular: float) -> None:
    """Refuse shares of energy that sum to more than 1."""
    if diffuse + specular > 1.0 + 1e-9:
        raise ValueError(
            f"diffuse {diffuse:g} + specular {specular:g} reflect more than arrives; lower one until they sum to 1"
        )
