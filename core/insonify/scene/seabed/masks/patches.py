"""Patches of relief."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from insonify.scene.base import parameter
from insonify.scene.seabed.masks import MaskKind
from insonify.scene.seabed.reliefs.spectrum import Density, Field


class PatchMask(MaskKind):
    """Smooth patches at random places, outside which the relief fades out."""

    rank = 20
    kind: Literal["patches"] = "patches"
    share: float = parameter(
        0.5, description="share of the bed that the patches cover", gt=0.0, lt=1.0, slider=(0.05, 0.95)
    )
    size: float = parameter(
        10.0, unit="m", description="typical width of a patch", ge=1e-3, le=1e5, slider=(1.0, 50.0), log=True
    )
    softness: float = parameter(
        0.3,
        description="width over which the relief fades at their borders, as a share of their size",
        gt=0.0,
        le=2.0,
        slider=(0.05, 1.0),
    )

    @property
    def coverage(self) -> float:
        """Share of the bed that the patches cover."""
        return self.share

    @property
    def spread(self) -> float:
        """Spread of the field's spectrum along each axis, cycles a metre."""
        return 1.0 / (2.0 * math.sqrt(2.0) * self.size)

    def density(self, narrowest: float = 0.0) -> Density:
        """Gaussian spectrum of unit variance whose rms frequency is that of waves two patches long."""
        spread = max(self.spread, narrowest)
        level = 1.0 / (2.0 * math.pi * spread**2)
        return lambda fx, fy: np.asarray(level * np.exp(-0.5 * (fx**2 + fy**2) / spread**2))

    def weigh(self, field: Field, threshold: float) -> Field:
        """Weight of the relief, from 0 outside the patches to 1 inside."""
        # The field's rms slope is π/size, so that a border so many sizes wide spans π times that of its values.
        share = np.clip((field - threshold) / (math.pi * self.softness) + 0.5, 0.0, 1.0)
        return np.asarray(share * share * (3.0 - 2.0 * share))
