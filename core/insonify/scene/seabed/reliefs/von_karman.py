"""Lineated roughness."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.base import angle, metres, parameter
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, rms_height
from insonify.scene.seabed.reliefs.spectrum import Band, Density, Field, rotate_frequencies


class VonKarman(ExtendableRelief):
    """Lineated roughness that levels off at long waves (Goff and Jordan 1988)."""

    rank = 40
    kind: Literal["von_karman"] = "von_karman"
    rms: float = rms_height()
    across: float = metres(
        5.0, "wavelength across the crests beyond which the spectrum levels off, 2π/k_n", (0.5, 100.0), most=1e6
    )
    along: float = metres(
        15.0, "wavelength along the crests beyond which the spectrum levels off, 2π/k_s", (0.5, 100.0), most=1e6
    )
    heading: float = angle("direction along the crests, counter-clockwise from +x")
    hurst: float = parameter(0.8, "exponent ν; the fractal dimension is 3 − ν", gt=0.0, le=3.0, slider=(0.1, 1.0))

    def density(self) -> Density:
        """P = 4πν h²/(k_n k_s) (1 + u²)^−(ν+1), u² = (k across/k_n)² + (k along/k_s)²: Goff and Jordan 1988, eq. 4."""
        across, along = self.across / (2.0 * math.pi), self.along / (2.0 * math.pi)
        level = 4.0 * math.pi * self.hurst * self.rms**2 * across * along

        def density(fx: Field, fy: Field) -> Field:
            f_along, f_across = rotate_frequencies(fx, fy, self.heading)
            squared = (2.0 * math.pi) ** 2 * ((f_across * across) ** 2 + (f_along * along) ** 2)
            return np.asarray(level * (1.0 + squared) ** -(self.hurst + 1.0))

        return density

    def bands(self) -> tuple[Band, ...]:
        """Return one band; its finest feature is the frequency at which it levels off."""
        return (Band(self.density(), 1.0 / max(self.across, self.along)),)
