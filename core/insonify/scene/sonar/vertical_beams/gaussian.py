"""A bell-shaped vertical beam."""

from __future__ import annotations

from typing import Literal

from insonify.scene.sonar.vertical_beams import VerticalResponse
from insonify.scene.sonar.vertical_beams.tilted import LobeBeam


class VerticalGaussian(LobeBeam):
    """A bell-shaped vertical beam."""

    rank = 30
    kind: Literal["gaussian"] = "gaussian"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self._named("gaussian")

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("gaussian", self.tilt, self.width)
