"""Time-varied gains, one file a kind."""

from __future__ import annotations

from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

GAINS = Family("gains", "insonify.scene.receiver.gains")


class RangeBins(NamedTuple):
    """Range bins to be amplified: their numbers from 0, and the slant ranges (m) and travel times (s) of centres."""

    number: NDArray[np.float64]
    slant_range: NDArray[np.float64]
    travel_time: NDArray[np.float64]


class GainKind(Choice):
    """Time-varied gain.

    Attributes
    ----------
    stops_at_noise : bool
        Whether the gain of the last bin in which a level bed of albedo 1 exceeds the noise holds beyond.
    """

    family = GAINS
    stops_at_noise: ClassVar[bool] = True

    def decibels(self, bins: RangeBins, absorption: float) -> NDArray[np.float64]:
        """Gain in dB of range bins, in water of that absorption (Np/m)."""
        del absorption
        return np.zeros(bins.number.shape)
