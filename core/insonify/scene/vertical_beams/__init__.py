"""Vertical beams, one file a kind."""

from __future__ import annotations

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

VERTICAL_BEAMS = Family("vertical_beams", "insonify.scene.vertical_beams")


class VerticalBeamKind(Choice):
    """Sensitivity of the sonar by grazing angle."""

    family = VERTICAL_BEAMS

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self.kind
