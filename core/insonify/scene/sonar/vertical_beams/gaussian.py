"""A bell-shaped vertical beam."""

from __future__ import annotations

from typing import Literal

from insonify.scene.sonar.vertical_beams import LobeBeam, VerticalResponse


class VerticalGaussian(LobeBeam):
    """A bell-shaped vertical beam."""

    rank = 30
    kind: Literal["gaussian"] = "gaussian"

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("gaussian", self.tilt, self.width)
