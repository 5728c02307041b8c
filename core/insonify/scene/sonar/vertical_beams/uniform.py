"""No vertical beam."""

from __future__ import annotations

from typing import Literal

from insonify.scene.sonar.vertical_beams import VerticalBeamKind


class UniformVerticalBeam(VerticalBeamKind):
    """Equal sensitivity at every grazing angle."""

    rank = 10
    kind: Literal["uniform"] = "uniform"
    caption = ""  # it changes nothing
