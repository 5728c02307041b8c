"""What a comb of planes misses of a beam's mean over waves along the track, by the waves' lengths.

A beam hears a wave of f cycles a metre as its mean over the beam's sensitivity, B(f), the transform of that; K planes
hear it as a sum over places a step δ apart. They differ by what the comb folds back: of a top-hat of the width W by
sin(πfW) (1 / (K sin(πfW/K)) − 1 / (πfW)), of a Gaussian by Σ B(f − m/δ) sinc(fδ − m) over all m, less B(f).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from insonify.planning import fitted_laws

Field = NDArray[np.float64]
SHORTEST, LONGEST = 1e-3, 1e4  # waves in a beam's width, of the table
FOLDS = 4  # by which waves are folded back, either way
PER_OCTAVE = 8  # widths of Gaussians that are told apart


class PlaneSampling:
    """Table of what planes miss, over waves whose frequencies lie at equal ratios.

    Parameters
    ----------
    frequencies : (n,) float64
        Cycles a metre along the track, at equal ratios.
    width : float
        Of the main lobe, in metres.
    half_power : float
        Of a Gaussian, half of its width at half power, over half the main lobe; 0 for a top-hat.
    worth : float
        Power of their number that planes are worth.
    """

    def __init__(self, frequencies: Field, width: float, half_power: float, worth: float = 1.0) -> None:
        ratio = math.log(frequencies[-1] / frequencies[0]) / (frequencies.size - 1)
        rounded = 2.0 ** (round(PER_OCTAVE * math.log2(half_power)) / PER_OCTAVE) if half_power > 0.0 else 0.0
        self._missed, self._mean = _table(rounded, worth, ratio)
        place = math.log(max(width * frequencies[0] / SHORTEST, 1.0)) / ratio
        self._first = min(int(place), self._mean.size - frequencies.size - 1)
        self._share = min(place - self._first, 1.0)
        self._size = frequencies.size

    @property
    def mean(self) -> Field:
        """Mean of each wave over the beam, (n,)."""
        return self._at(self._mean)

    @property
    def missed(self) -> Field:
        """Mean square by which planes miss that, (counts, n), for each of ``laws.COUNTS``."""
        return self._at(self._missed)

    def _at(self, table: Field) -> Field:
        first, last = self._first, self._first + self._size
        near = table[..., first:last]
        return np.asarray(near + self._share * (table[..., first + 1 : last + 1] - near))


@lru_cache(maxsize=64)
def _table(half_power: float, worth: float, ratio: float) -> tuple[Field, Field]:
    """Mean square that each count of planes misses, (counts, waves), and the mean over the beam, (waves,)."""
    waves = SHORTEST * np.exp(ratio * np.arange(math.ceil(math.log(LONGEST / SHORTEST) / ratio)))
    count = np.asarray(fitted_laws.COUNTS, dtype=np.float64)[:, None] ** worth
    if half_power == 0.0:
        mean = np.sinc(waves)
        turns, y = np.minimum(waves / count, 0.5), np.pi * waves
        # Squared sines stand for their mean up to there, for a beam's width and its waves are all of a range.
        missed = 0.5 * (1.0 - np.sinc(2.0 * waves)) * (1.0 / (count * np.sin(np.pi * turns)) - 1.0 / y) ** 2
        missed = np.where(turns < 0.5, np.minimum(missed, 1.0 / count), 1.0 / count)
    else:
        transform = 0.25 * math.pi**2 * half_power**2 / math.log(2.0)
        mean = np.exp(-transform * waves**2)
        missed = np.zeros((count.size, waves.size)) - mean
        for m in range(-FOLDS, FOLDS + 1):
            folded = np.exp(-transform * (waves - m * count) ** 2) * np.sinc(waves / count - m)
            missed += (-1.0) ** m * folded
        missed = missed**2
    missed[0] = (1.0 - mean) ** 2
    return missed, mean
