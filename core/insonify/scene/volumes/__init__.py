"""Volumes of the water column that echo: schools of fish, plumes of bubbles."""

import math
from typing import Annotated, NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import Coordinate, Family, Kind, KindOf, angle, decibels, metres, parameter

VOLUMES = Family("volumes", "insonify.scene.volumes")
SPACING = 0.15  # m, between the points by which a volume is sampled
FEWEST_POINTS, MOST_POINTS = 1000, 200_000  # points of a volume
# Steps of the evenest sequence in three dimensions (Roberts 2018): powers of the inverse root of x⁴ = x + 1.
SEQUENCE_STEPS = 1.2207440846057596 ** -np.arange(1.0, 4.0)


class VolumeSamples(NamedTuple):
    """Points spread evenly over a volume, (n, 3) in metres with the sea surface at 0, and the m³ of each."""

    points: Floats
    each: float


class Volume(Kind):
    """A part of the water column that echoes."""

    family = VOLUMES

    position: tuple[Coordinate, Coordinate, Coordinate] = parameter(
        description="[x, y, z], z up from the sea surface", unit="m"
    )
    strength: float = decibels(-25.0, "backscattering strength of a cubic metre", (-200.0, 20.0), (-60.0, 0.0))
    heading: float = angle("heading, counter-clockwise from east; 45T is 45° by the compass")

    @property
    def cubic_metres(self) -> float:
        """Volume, in m³."""
        raise NotImplementedError

    def place(self, unit: Floats) -> Floats:
        """Map points that fill the unit cube evenly, (n, 3), to the volume, its heading along +x, from `position`."""
        raise NotImplementedError

    def sample(self) -> VolumeSamples:
        """Points spread evenly over the volume where it lies."""
        count = int(np.clip(self.cubic_metres / SPACING**3, FEWEST_POINTS, MOST_POINTS))
        own = self.place(np.mod(0.5 + np.arange(1, count + 1)[:, None] * SEQUENCE_STEPS, 1.0))
        c, s = math.cos(math.radians(self.heading)), math.sin(math.radians(self.heading))
        turned = np.stack([c * own[:, 0] - s * own[:, 1], s * own[:, 0] + c * own[:, 1], own[:, 2]], axis=1)
        return VolumeSamples(turned + np.array(self.position), self.cubic_metres / count)


class School(Volume, kind="school", rank=10):
    """A school of fish: an ellipsoid about its position; -25 dB are thirty fish of -40 dB in a cubic metre."""

    length: float = metres(10.0, "extent along its heading", (1.0, 100.0), most=1e4)
    width: float = metres(5.0, "extent across its heading", (1.0, 100.0), most=1e4)
    height: float = metres(3.0, "from its underside to its top", (0.5, 30.0), most=1e4)

    @property
    def cubic_metres(self) -> float:
        """Volume, in m³."""
        return math.pi / 6.0 * self.length * self.width * self.height

    def place(self, unit: Floats) -> Floats:
        """Map points of the unit cube to the ellipsoid: r³, the cosine to the vertical and the azimuth are even."""
        rho, up, azimuth = np.cbrt(unit[:, 0]), 2.0 * unit[:, 1] - 1.0, 2.0 * math.pi * unit[:, 2]
        level = np.sqrt(1.0 - up**2)
        ball = rho[:, None] * np.stack([level * np.cos(azimuth), level * np.sin(azimuth), up], axis=1)
        return ball * (0.5 * np.array([self.length, self.width, self.height]))


class Plume(Volume, kind="plume", rank=20):
    """A plume of bubbles that rises from its position, widens evenly and drifts along its heading."""

    height: float = metres(15.0, "from the vent to its top", (1.0, 100.0), most=1e4)
    radius: float = metres(1.0, "radius at its top", (0.1, 10.0), most=1e4)
    drift: float = parameter(0.0, "drift of its top along the heading", "m", ge=0.0, le=1e4, slider=(0.0, 50.0))

    @property
    def cubic_metres(self) -> float:
        """Volume, in m³."""
        return math.pi / 3.0 * self.radius**2 * self.height

    def place(self, unit: Floats) -> Floats:
        """Map points of the unit cube to the cone: the cubed height, the squared radius and the azimuth are even."""
        up, azimuth = np.cbrt(unit[:, 0]), 2.0 * math.pi * unit[:, 2]
        rho = self.radius * up * np.sqrt(unit[:, 1])
        x = rho * np.cos(azimuth) + self.drift * up
        return np.stack([x, rho * np.sin(azimuth), self.height * up], axis=1)


AnyVolume = Annotated[Volume, KindOf(VOLUMES)]
