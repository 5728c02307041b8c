"""Beams without sidelobes: a knife without width, a fan, and a bell-shaped beam."""

import math
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.sonar.beams import AimedBeam, BeamConditions, BeamKind, Values

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


class KnifeBeam(BeamKind):
    """A beam without width: a vertical plane across the track at any pitch of the towfish, 1 m wide by definition."""

    rank = 10
    top_hat = True
    has_width = False
    caption = "knife-edge beam"
    kind: Literal["knife"] = "knife"

    def half_width(self, conditions: BeamConditions) -> float:
        """Zero: the beam is a plane."""
        return 0.0


class FanBeam(AimedBeam):
    """A top-hat beam, one-way full width; the cell widens with range."""

    rank = 20
    top_hat = True
    caption = "fan {width:g}°"
    kind: Literal["fan"] = "fan"
    width: float = parameter(1.0, "one-way full beamwidth", "°", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True)

    def half_width(self, conditions: BeamConditions) -> float:
        """Half of the one-way full width, in radians."""
        return math.radians(self.width) / 2.0
