"""Vertical beams without a lobe and with a single one."""

from typing import ClassVar, Literal

from insonify.scene.base import parameter
from insonify.scene.sonar.vertical_beams import TiltedBeam, VerticalBeamKind, VerticalResponse


class UniformVerticalBeam(VerticalBeamKind):
    """Equal sensitivity at every grazing angle."""

    rank = 10
    kind: Literal["uniform"] = "uniform"
    caption = ""  # it changes nothing


class LobeBeam(TiltedBeam):
    """A vertical beam of a single lobe of given width."""

    lobe: ClassVar[Literal["top_hat", "gaussian"]]
    caption = "vertical {kind} {width:g}° tilted {tilt:g}°"
    width: float = parameter(
        50.0, "one-way full width; to -3 dB of a gaussian", "°", ge=1e-3, le=170.0, slider=(5.0, 90.0)
    )

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse(self.lobe, self.tilt, self.width)


class VerticalFan(LobeBeam):
    """A vertical top-hat: full sensitivity within its width, none beyond."""

    rank = 20
    lobe = "top_hat"
    kind: Literal["fan"] = "fan"


class VerticalGaussian(LobeBeam):
    """A bell-shaped vertical beam."""

    rank = 30
    lobe = "gaussian"
    kind: Literal["gaussian"] = "gaussian"
