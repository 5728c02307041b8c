"""Vertical beams, one file a kind."""

from __future__ import annotations

from typing import Literal, NamedTuple

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

VERTICAL_BEAMS = Family("vertical_beams", "insonify.scene.vertical_beams")


class VerticalResponse(NamedTuple):
    """Sensitivity by grazing angle: its shape, the depression of its axis and its one-way full width in degrees."""

    shape: Literal["every_grazing", "top_hat", "gaussian"]
    tilt: float = 0.0
    width: float = 180.0


class VerticalBeamKind(Choice):
    """Sensitivity of the sonar by grazing angle."""

    family = VERTICAL_BEAMS

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self.kind

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("every_grazing")

    @property
    def shades(self) -> bool:
        """Whether the sensitivity depends on the grazing angle."""
        return self.response.shape != "every_grazing"
