"""The vertical beam of an array."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import metres, parameter
from insonify.scene.sonar.beams.line_array import ELEMENTS, taper_weights
from insonify.scene.sonar.vertical_beams import TiltedBeam, VerticalResponse

FEWEST_COLUMNS, PER_LOBE = 1025, 32  # of the table of sensitivities


class VerticalArray(TiltedBeam):
    """The vertical beam of a transducer of given height, with its sidelobes."""

    rank = 40
    by_frequency = True
    kind: Literal["array"] = "array"
    height: float = metres(0.005, "height of the transducer", (0.001, 0.05), least=1e-4, most=0.25)
    taper: Literal["uniform", "cosine", "hamming", "taylor"] = parameter(
        "uniform", "weight over the height; a tapered transducer has lower sidelobes and a wider beam"
    )

    @property
    def words(self) -> str:
        """Name of the beam for captions."""
        return f"{self.taper} array {1e3 * self.height:g} mm high tilted {self.tilt:g}°"

    @property
    def response(self) -> VerticalResponse:
        """Sensitivity by grazing angle."""
        return VerticalResponse("table", self.tilt)

    def sensitivity(self, wavelength: float) -> NDArray[np.float64]:
        """Tabulate |∫ w(u) exp(−iku s) du|² over sines s (Urick 1983, ch. 3): sin²(x)/x², x = πhs/λ, if uniform."""
        from scipy.signal import czt  # lazy: takes longer to import than a preview takes to trace

        columns = max(FEWEST_COLUMNS, 2 * math.ceil(PER_LOBE * self.height / wavelength) + 1)
        phase = 2.0 * math.pi / wavelength * self.height / ELEMENTS  # between neighbouring elements, per unit of sine
        step = np.exp(-2j * phase / (columns - 1))
        return np.asarray(np.abs(czt(taper_weights(self.taper), columns, step, np.exp(-1j * phase))) ** 2)
