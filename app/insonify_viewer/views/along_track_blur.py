"""A beam's blur along the track, of a picture."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray


def smeared(columns: NDArray[np.float32], reach: NDArray[np.float64]) -> NDArray[np.float32]:
    """Average energies along the track over as many pings as a beam takes in.

    Parameters
    ----------
    columns : (n, width) float32
        Amplitudes of pings in succession, from far port over nadir to far starboard.
    reach : (bins,) float64
        Pings that the beam takes in, by range bin; less than one is one.

    Returns
    -------
    (n, width) float32
        Beyond the ends the first ping and the last are taken to go on.
    """
    half = _half(reach, columns.shape[1])
    margin = int(half.max() + 0.5) + 1
    energy = np.square(np.pad(columns, ((margin, margin), (0, 0)), mode="edge"))
    total = np.zeros((len(energy) + 1, columns.shape[1]), dtype=np.float32)
    np.cumsum(energy, axis=0, out=total[1:])
    out = columns.copy()
    whole = np.floor(half + 0.5).astype(np.int64)
    part = (half + 0.5 - whole).astype(np.float32)
    ends = np.flatnonzero(np.diff(whole, prepend=-1, append=-1))
    # Between two ends the averages begin and end in the same rows, further out in later ones.
    for run in (slice(first, end) for first, end in pairwise(ends) if whole[first] > 0):
        far, near = margin + int(whole[run.start]), margin + 1 - int(whole[run.start])
        above, below = total[:, run], part[run]
        n = len(columns)
        summed = above[far : far + n] - above[near : near + n]
        summed += below * (energy[far : far + n, run] + energy[near - 1 : near - 1 + n, run])
        summed /= (2.0 * half[run]).astype(np.float32)
        out[:, run] = np.sqrt(np.maximum(summed, 0.0))  # sums may round below what they are the difference of
    return out


def _half(reach: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Half of what is averaged in every column, in pings."""
    across = np.abs(2.0 * (np.arange(width) + 0.5) / width - 1.0)
    return 0.5 * np.maximum(reach[np.minimum((across * reach.size).astype(np.int64), reach.size - 1)], 1.0)
