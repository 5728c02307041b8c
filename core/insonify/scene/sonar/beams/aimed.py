"""Beams that can be turned towards the bow."""

from __future__ import annotations

from insonify.scene.base import parameter
from insonify.scene.sonar.beams import BeamKind


class AimedBeam(BeamKind):
    """A beam with a direction."""

    squint: float = parameter(
        0.0,
        unit="°",
        description="angle by which the beam is turned towards the bow",
        ge=-45.0,
        le=45.0,
        slider=(-10.0, 10.0),
        rare=True,
    )

    @property
    def axis(self) -> float:
        """Angle of the beam's axis towards the bow, in degrees."""
        return self.squint

    def _named(self, name: str) -> str:
        return f"{name}, squint {self.squint:g}°" if self.squint else name
