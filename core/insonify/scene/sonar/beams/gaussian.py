"""A bell-shaped beam."""

import math
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.sonar.beams import AimedBeam, BeamConditions, Values

FAINT = 1e-6  # sensitivity at which the beam ends
EDGE = 0.02  # sensitivity at which its main lobe ends


class GaussianBeam(AimedBeam):
    """A bell-shaped beam without sidelobes."""

    rank = 30
    caption = "gaussian {width:g}° {ways}"
    kind: Literal["gaussian"] = "gaussian"
    width: float = parameter(
        1.0, "one-way full beamwidth to -3 dB", "°", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True
    )
    two_way: bool = parameter(
        True, "whether the pattern applies to transmission and reception, or only once", rare=True
    )

    @property
    def _s_three_decibels(self) -> float:
        return math.sin(math.radians(self.width) / 2.0)

    def half_width(self, conditions: BeamConditions) -> float:
        """Angle at which the sensitivity is `EDGE`, in radians."""
        times = math.sqrt(math.log2(1.0 / EDGE) / self.passes)
        return math.asin(min(self._s_three_decibels * times, 1.0))

    def extent(self, conditions: BeamConditions) -> float:
        """Sine of the angle at which the sensitivity is `FAINT`."""
        return min(self._s_three_decibels * math.sqrt(math.log2(1.0 / FAINT) / self.passes), 1.0)

    def response(self, s: Values, conditions: BeamConditions) -> Values:
        """Sensitivity b = 2^(−(2φ/w)²) each way, which falls to a half at half the width."""
        return np.exp2(-self.passes * (s / self._s_three_decibels) ** 2)
