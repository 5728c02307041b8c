"""Plumes of gas."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import parameter
from insonify.scene.volumes import Volume, measure


class Plume(Volume):
    """A plume of bubbles that rises from its position, widens evenly and drifts along its heading."""

    rank = 20
    kind: Literal["plume"] = "plume"
    height: float = measure(15.0, "from the vent to its top", (1.0, 100.0))
    radius: float = measure(1.0, "at its top", (0.1, 10.0))
    drift: float = parameter(
        0.0, unit="m", description="of its top along the heading", ge=0.0, le=1e4, slider=(0.0, 50.0)
    )

    @property
    def cubic_metres(self) -> float:
        """Volume, in m³."""
        return math.pi / 3.0 * self.radius**2 * self.height

    def place(self, unit: NDArray[np.float64]) -> NDArray[np.float64]:
        """Map points of the unit cube to the cone: the cubed height, the squared radius and the azimuth are even."""
        up, azimuth = np.cbrt(unit[:, 0]), 2.0 * math.pi * unit[:, 2]
        rho = self.radius * up * np.sqrt(unit[:, 1])
        x = rho * np.cos(azimuth) + self.drift * up
        return np.stack([x, rho * np.sin(azimuth), self.height * up], axis=1)
