"""Horizontal beams, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

BEAMS = Family("beams", "insonify.scene.beams")


class BeamKind(Choice):
    """Sensitivity of the sonar along the track."""

    family = BEAMS

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self.kind
