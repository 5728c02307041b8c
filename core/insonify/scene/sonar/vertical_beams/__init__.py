"""Vertical beams: their base classes, and those without a lobe or with a single one."""

from typing import ClassVar, Literal, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, parameter

VERTICAL_BEAMS = Family("vertical_beams", "insonify.scene.sonar.vertical_beams")


class VerticalResponse(NamedTuple):
    """Sensitivity by grazing angle."""

    # That of a ``table`` is tabulated by `VerticalBeamKind.sensitivity`.
    shape: Literal["every_grazing", "top_hat", "gaussian", "table"]
    tilt: float = 0.0  # degrees, depression of the axis
    width: float = 180.0  # degrees, one-way full width


class VerticalBeamKind(Kind):
    """Sensitivity of the sonar by grazing angle.

    Attributes
    ----------
    by_frequency : bool
        Whether it depends on the frequency.
    caption : str
        Name of the beam for captions, with its fields in braces.
    """

    family = VERTICAL_BEAMS
    by_frequency: ClassVar[bool] = False
    caption: ClassVar[str] = "{kind}"

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return self.caption.format(**dict(self))

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("every_grazing")

    @property
    def shades(self) -> bool:
        """Whether the sensitivity depends on the grazing angle."""
        return self.response.shape != "every_grazing"

    def sensitivity(self, wavelength: float) -> Floats:
        """Tabulate the one-way energy at equal steps of the sine of the angle above the axis, from -1 to 1.

        Parameters
        ----------
        wavelength : float
            Wavelength of the sound, in metres.
        """
        return np.ones(2)


class TiltedBeam(VerticalBeamKind):
    """A vertical beam with an axis."""

    tilt: float = parameter(
        30.0, "depression of the axis below the level towfish", "°", ge=-90.0, le=90.0, slider=(0.0, 60.0)
    )

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle: the table of `sensitivity`, unless a kind has a closed form."""
        return VerticalResponse("table", self.tilt)


class UniformVerticalBeam(VerticalBeamKind, kind="uniform", rank=10):
    """Equal sensitivity at every grazing angle."""

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


class VerticalFan(LobeBeam, kind="fan", rank=20):
    """A vertical top-hat: full sensitivity within its width, none beyond."""

    lobe = "top_hat"


class VerticalGaussian(LobeBeam, kind="gaussian", rank=30):
    """A bell-shaped vertical beam."""

    lobe = "gaussian"
