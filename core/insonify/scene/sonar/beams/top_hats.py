"""Top-hat beams: a fan, and a knife without width."""

import math
from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.sonar.beams import AimedBeam, BeamConditions, BeamKind


class KnifeBeam(BeamKind):
    """A beam without width: a vertical plane across the track at any pitch of the fish, 1 m wide by definition."""

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
