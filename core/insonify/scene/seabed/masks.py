"""Mask that limits a relief to parts of the bed."""

import math

import numpy as np

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, metres, parameter
from insonify.scene.seabed.reliefs.spectrum import Density

MASKS = Family("masks", "insonify.scene.seabed")


class PatchMask(Kind, kind="patches"):
    """Smooth patches at random places, outside which the relief fades out and the bed is level.

    They are cut at a threshold from a Gaussian field of unit variance.
    """

    family = MASKS
    share: float = parameter(0.5, "share of the bed that the patches cover", gt=0.0, lt=1.0, slider=(0.05, 0.95))
    size: float = metres(10.0, "typical width of a patch", (1.0, 50.0), least=1e-3, most=1e5)
    softness: float = parameter(
        0.3,
        "width over which the relief fades at their borders, as a share of their size",
        gt=0.0,
        le=2.0,
        slider=(0.05, 1.0),
    )

    @property
    def spread(self) -> float:
        """Spread of the field's spectrum along each axis, cycles a metre."""
        return 1.0 / (2.0 * math.sqrt(2.0) * self.size)

    def density(self, narrowest: float = 0.0) -> Density:
        """Spectral density of the field: Gaussian, with the rms frequency of waves two patches long."""
        spread = max(self.spread, narrowest)  # cycles a metre
        level = 1.0 / (2.0 * math.pi * spread**2)
        return lambda fx, fy: np.asarray(level * np.exp(-0.5 * (fx**2 + fy**2) / spread**2))

    def weigh(self, field: Floats, threshold: float) -> Floats:
        """Weight of the relief, from 0 outside the patches to 1 inside, from the field and its value on the borders."""
        # The field's rms slope is π/size, so that a border of that width in sizes spans π times that of its values.
        share = np.clip((field - threshold) / (math.pi * self.softness) + 0.5, 0.0, 1.0)
        return np.asarray(share * share * (3.0 - 2.0 * share))
