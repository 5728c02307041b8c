"""A vertical top-hat."""

from __future__ import annotations

from typing import Literal

from insonify.scene.sonar.vertical_beams import LobeBeam, VerticalResponse


class VerticalFan(LobeBeam):
    """A vertical top-hat: full sensitivity within its width, none beyond."""

    rank = 20
    kind: Literal["fan"] = "fan"

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("top_hat", self.tilt, self.width)
