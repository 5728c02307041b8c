"""A beam without width."""

from __future__ import annotations

from typing import Literal

from insonify.scene.sonar.beams import BeamConditions, BeamKind


class KnifeBeam(BeamKind):
    """A beam without width: a vertical plane across the track at any pitch of the fish, 1 m wide by definition."""

    rank = 10
    top_hat = True
    has_width = False
    kind: Literal["knife"] = "knife"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return "knife-edge beam"

    def half_width(self, conditions: BeamConditions) -> float:
        """Zero: the beam is a plane."""
        return 0.0
