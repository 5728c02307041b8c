"""A measured vertical beam."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator

from insonify.scene.base import parameter
from insonify.scene.sonar.vertical_beams import TiltedBeam, VerticalResponse

COLUMNS = 4097  # of the table of sensitivities
Angle = Annotated[float, Field(ge=-90.0, le=90.0)]
Level = Annotated[float, Field(ge=-200.0, le=100.0)]


class MeasuredVerticalBeam(TiltedBeam):
    """A vertical beam of measured levels, interpolated linearly."""

    rank = 50
    caption = "measured vertical beam tilted {tilt:g}°"
    kind: Literal["table"] = "table"
    levels: tuple[tuple[Angle, Level], ...] = parameter(
        ((-60.0, -30.0), (-25.0, -3.0), (0.0, 0.0), (25.0, -3.0), (60.0, -30.0)),
        "pairs [angle below the axis in degrees, one-way level], ascending; the outermost apply beyond",
        "dB",
        slider=(-60.0, 0.0),
        min_length=1,
        max_length=4096,
    )

    @field_validator("levels")
    @classmethod
    def _ascending(cls, levels: tuple[tuple[Angle, Level], ...]) -> tuple[tuple[Angle, Level], ...]:
        if any(after[0] <= before[0] for before, after in pairwise(levels)):
            raise ValueError("must run in order of increasing angle; sort the pairs and drop doubles")
        return levels

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("table", self.tilt)

    def sensitivity(self, wavelength: float) -> NDArray[np.float64]:
        """Tabulate the measured levels as energies."""
        below, decibels = np.array(self.levels).T
        angles = -np.degrees(np.arcsin(np.linspace(-1.0, 1.0, COLUMNS)))
        return np.asarray(10.0 ** (np.interp(angles, below, decibels) / 10.0))
