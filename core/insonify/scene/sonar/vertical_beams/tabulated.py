"""Vertical beams by a table of sensitivities: of a transducer of given height, and measured ones."""

import math
from functools import partial
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field

from insonify.arrays import Floats
from insonify.scene.base import check_increasing, metres, parameter
from insonify.scene.sonar.beams.line_array import ELEMENTS, taper_weights
from insonify.scene.sonar.vertical_beams import TiltedBeam

LEVEL_COLUMNS = 4097  # of the table of measured sensitivities
Angle = Annotated[float, Field(ge=-90.0, le=90.0)]
Level = Annotated[float, Field(ge=-200.0, le=100.0)]
IN_ORDER = AfterValidator(partial(check_increasing, "angle"))
FEWEST_COLUMNS, PER_LOBE = 1025, 32  # of the table of a transducer


class VerticalArray(TiltedBeam, kind="array", rank=40):
    """The vertical beam of a transducer of given height, with its sidelobes."""

    by_frequency = True
    height: float = metres(0.005, "height of the transducer", (0.001, 0.05), least=1e-4, most=0.25)
    taper: Literal["uniform", "cosine", "hamming", "taylor"] = parameter(
        "uniform", "weight over the height; a tapered transducer has lower sidelobes and a wider beam"
    )

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return f"{self.taper} array {1e3 * self.height:g} mm high tilted {self.tilt:g}°"

    def sensitivity(self, wavelength: float) -> Floats:
        """Tabulate |∫ w(u) exp(−iku s) du|² over sines s (Urick 1983, ch. 3): sin²(x)/x², x = πhs/λ, if uniform."""
        from scipy.signal import czt  # lazy: takes longer to import than a preview takes to trace

        columns = max(FEWEST_COLUMNS, 2 * math.ceil(PER_LOBE * self.height / wavelength) + 1)
        phase = 2.0 * math.pi / wavelength * self.height / ELEMENTS  # between neighbouring elements, per unit of sine
        step = np.exp(-2j * phase / (columns - 1))
        return np.asarray(np.abs(czt(taper_weights(self.taper), columns, step, np.exp(-1j * phase))) ** 2)


class MeasuredVerticalBeam(TiltedBeam, kind="table", rank=50):
    """A vertical beam of measured levels, interpolated linearly."""

    caption = "measured vertical beam tilted {tilt:g}°"
    levels: Annotated[tuple[tuple[Angle, Level], ...], IN_ORDER] = parameter(
        ((-60.0, -30.0), (-25.0, -3.0), (0.0, 0.0), (25.0, -3.0), (60.0, -30.0)),
        "pairs [angle below the axis in degrees, one-way level], ascending; the outermost apply beyond",
        "dB",
        slider=(-60.0, 0.0),
        min_length=1,
        max_length=4096,
    )

    def sensitivity(self, wavelength: float) -> Floats:
        """Tabulate the measured levels as energies."""
        below, decibels = np.array(self.levels).T
        angles = -np.degrees(np.arcsin(np.linspace(-1.0, 1.0, LEVEL_COLUMNS)))
        return np.asarray(10.0 ** (np.interp(angles, below, decibels) / 10.0))
