"""Sampling error of planes across a beam for waves along the track, by wavelength.

The response of a beam to a wave of f cycles per metre is the transform B(f) of its sensitivity. K planes replace the
integral by a sum over positions a step δ apart. The two differ by aliasing: for a top-hat of width W by
sin(πfW) (1 / (K sin(πfW/K)) − 1 / (πfW)), for a Gaussian by Σ B(f − m/δ) sinc(fδ − m) over all m, less B(f).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from insonify.planning import fitted_laws

Field = NDArray[np.float64]
SHORTEST, LONGEST = 1e-3, 1e4  # bounds of the table, in waves per beam width
FOLDS = 4  # aliases that are summed on either side
PER_OCTAVE = 8  # widths of Gaussians that are distinguished


class PlaneSampling:
    """Sampling error of planes across a beam, for waves whose frequencies form a geometric series.

    Parameters
    ----------
    frequencies : (n,) float64
        Cycles per metre along the track, a geometric series.
    width : float
        Width of the main lobe, in metres.
    half_power : float
        Half width of a Gaussian at half power, over half the main lobe; 0 for a top-hat.
    worth : float
        Exponent of the effective number of planes: K planes count as K^worth.
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
        """Response of the beam to each wave, (n,)."""
        return self._at(self._mean)

    @property
    def missed(self) -> Field:
        """Mean square error of that response, (counts, n), for each plane count in ``fitted_laws.COUNTS``."""
        return self._at(self._missed)

    def _at(self, table: Field) -> Field:
        first, last = self._first, self._first + self._size
        near = table[..., first:last]
        return np.asarray(near + self._share * (table[..., first + 1 : last + 1] - near))


@lru_cache(maxsize=64)
def _table(half_power: float, worth: float, ratio: float) -> tuple[Field, Field]:
    """Mean square error of each plane count, (counts, waves), and the response of the beam, (waves,)."""
    waves = SHORTEST * np.exp(ratio * np.arange(math.ceil(math.log(LONGEST / SHORTEST) / ratio)))
    count = np.asarray(fitted_laws.COUNTS, dtype=np.float64)[:, None] ** worth
    if half_power == 0.0:
        mean = np.sinc(waves)
        turns, y = np.minimum(waves / count, 0.5), np.pi * waves
        # sin² is averaged over all lower frequencies, because widths and wavelengths cover a range.
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
