"""Volumes of the water column that echo: schools of fish, plumes of bubbles; one file a kind."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import Choice, Place, parameter
from insonify.scene.kinds import Family, KindOf

VOLUMES = Family("volumes", "insonify.scene.volumes")
SPACING = 0.15  # m, between the points by which a volume is sampled
FEWEST, MOST = 1000, 200_000  # points of a volume
# Steps of the evenest sequence in three dimensions (Roberts 2018): powers of the inverse root of x⁴ = x + 1.
STEPS = 1.2207440846057596 ** -np.arange(1.0, 4.0)


class VolumeSamples(NamedTuple):
    """Points spread evenly over a volume, (n, 3) in metres with the sea surface at 0, and the m³ of each."""

    points: NDArray[np.float64]
    each: float


class Volume(Choice):
    """A part of the water column that echoes."""

    family = VOLUMES

    position: tuple[Place, Place, Place] = parameter(unit="m", description="[x, y, z], z up from the sea surface")
    strength: float = parameter(
        -25.0,
        unit="dB",
        description="backscattering strength of a cubic metre",
        ge=-200.0,
        le=20.0,
        slider=(-60.0, 0.0),
    )
    heading: float = parameter(
        0.0, unit="°", description="counter-clockwise from +x", ge=-360.0, le=360.0, slider=(-180.0, 180.0)
    )

    @property
    def cubic_metres(self) -> float:
        """Volume, in m³."""
        raise NotImplementedError

    def place(self, unit: NDArray[np.float64]) -> NDArray[np.float64]:
        """Map points that fill the unit cube evenly, (n, 3), to the volume, its heading along +x, from `position`."""
        raise NotImplementedError

    def sample(self) -> VolumeSamples:
        """Points spread evenly over the volume where it lies."""
        count = int(np.clip(self.cubic_metres / SPACING**3, FEWEST, MOST))
        own = self.place(np.mod(0.5 + np.arange(1, count + 1)[:, None] * STEPS, 1.0))
        c, s = math.cos(math.radians(self.heading)), math.sin(math.radians(self.heading))
        turned = np.stack([c * own[:, 0] - s * own[:, 1], s * own[:, 0] + c * own[:, 1], own[:, 2]], axis=1)
        return VolumeSamples(turned + np.array(self.position), self.cubic_metres / count)


def measure(default: float, description: str, slider: tuple[float, float]) -> Any:
    """Declare a measure of a volume, in metres."""
    return parameter(default, unit="m", description=description, gt=0.0, le=1e4, slider=slider, log=True)


AnyVolume = Annotated[Volume, KindOf(VOLUMES)]
