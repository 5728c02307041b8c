"""A vertical top-hat."""

from __future__ import annotations

from typing import Literal

from insonify.scene.sonar.vertical_beams import VerticalResponse
from insonify.scene.sonar.vertical_beams.tilted import LobeBeam


class VerticalFan(LobeBeam):
    """A vertical top-hat: all within its width, nothing beyond."""

    rank = 20
    kind: Literal["fan"] = "fan"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named("fan")

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("top_hat", self.tilt, self.width)
