"""Ringing that decays."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import parameter
from insonify.scene.receiver.ringings import RingingKind


class DecayingRinging(RingingKind):
    """Ringing whose energy decays exponentially after transmission."""

    rank = 20
    kind: Literal["decay"] = "decay"
    level: float = parameter(
        -40.0,
        unit="dB",
        description="level at the end of the transmission, dB re the source at 1 m",
        ge=-300.0,
        le=0.0,
        slider=(-100.0, 0.0),
    )
    time: float = parameter(
        5e-4,
        unit="s",
        description="time in which its energy falls to 1/e",
        gt=0.0,
        le=1.0,
        slider=(1e-5, 1e-2),
        log=True,
    )

    def decibels(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Level in dB, a straight line over time."""
        return self.level - 10.0 / math.log(10.0) * time / self.time
