"""A top-hat beam."""

from __future__ import annotations

import math
from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.sonar.beams import AimedBeam, BeamConditions


class FanBeam(AimedBeam):
    """A top-hat beam, one-way full width; the cell widens with range."""

    rank = 20
    top_hat = True
    kind: Literal["fan"] = "fan"
    width: float = parameter(1.0, "one-way full beamwidth", "°", ge=1e-3, le=60.0, slider=(0.1, 10.0), log=True)

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named(f"fan {self.width:g}°")

    def half_width(self, conditions: BeamConditions) -> float:
        """Half of the one-way full width, in radians."""
        return math.radians(self.width) / 2.0
