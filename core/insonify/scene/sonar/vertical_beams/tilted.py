"""Vertical beams with an axis."""

from __future__ import annotations

from insonify.scene.base import parameter
from insonify.scene.sonar.vertical_beams import VerticalBeamKind


class TiltedBeam(VerticalBeamKind):
    """A vertical beam with an axis."""

    tilt: float = parameter(
        30.0, unit="°", description="depression of the axis below the level fish", ge=-90.0, le=90.0, slider=(0.0, 60.0)
    )


class LobeBeam(TiltedBeam):
    """A vertical beam of a single lobe of given width."""

    width: float = parameter(
        50.0, unit="°", description="one-way full width; to -3 dB of a gaussian", ge=1e-3, le=170.0, slider=(5.0, 90.0)
    )

    def _named(self, name: str) -> str:
        return f"vertical {name} {self.width:g}° tilted {self.tilt:g}°"
