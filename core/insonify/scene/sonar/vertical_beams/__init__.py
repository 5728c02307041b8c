"""Vertical beams, one file a kind."""

from __future__ import annotations

from typing import ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

VERTICAL_BEAMS = Family("vertical_beams", "insonify.scene.sonar.vertical_beams")


class VerticalResponse(NamedTuple):
    """Sensitivity by grazing angle: its shape, the depression of its axis and its one-way full width in degrees.

    A kind of the shape ``table`` declares the sensitivity by `VerticalBeamKind.sensitivity`.
    """

    shape: Literal["every_grazing", "top_hat", "gaussian", "table"]
    tilt: float = 0.0
    width: float = 180.0


class VerticalBeamKind(Choice):
    """Sensitivity of the sonar by grazing angle.

    Attributes
    ----------
    by_frequency : bool
        Whether the frequency changes it.
    """

    family = VERTICAL_BEAMS
    by_frequency: ClassVar[bool] = False

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

    def sensitivity(self, wavelength: float) -> NDArray[np.float64]:
        """Tabulate the one-way energy at equal steps of the sine of the angle above the axis, from -1 to 1.

        Parameters
        ----------
        wavelength : float
            Metres.
        """
        del wavelength
        return np.ones(2)
