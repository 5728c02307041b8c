"""Schools of fish."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.volumes import Volume, measure


class School(Volume):
    """A school of fish: an ellipsoid about its position; -25 dB are thirty fish of -40 dB in a cubic metre."""

    rank = 10
    kind: Literal["school"] = "school"
    length: float = measure(10.0, "along its heading", (1.0, 100.0))
    width: float = measure(5.0, "across its heading", (1.0, 100.0))
    height: float = measure(3.0, "from its underside to its top", (0.5, 30.0))

    @property
    def cubic_metres(self) -> float:
        """Volume, in m³."""
        return math.pi / 6.0 * self.length * self.width * self.height

    def place(self, unit: NDArray[np.float64]) -> NDArray[np.float64]:
        """Map points of the unit cube to the ellipsoid: r³, the cosine to the vertical and the azimuth are even."""
        rho, up, azimuth = np.cbrt(unit[:, 0]), 2.0 * unit[:, 1] - 1.0, 2.0 * math.pi * unit[:, 2]
        level = np.sqrt(1.0 - up**2)
        ball = rho[:, None] * np.stack([level * np.cos(azimuth), level * np.sin(azimuth), up], axis=1)
        return ball * (0.5 * np.array([self.length, self.width, self.height]))
