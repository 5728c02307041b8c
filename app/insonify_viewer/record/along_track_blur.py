"""Along-track blur of a record by the width of the beam."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray


def blur_along_track(columns: NDArray[np.float32], reach: NDArray[np.float64]) -> NDArray[np.float32]:
    """Average energy over the number of successive pings that the beam covers."""
    half = 0.5 * np.maximum(reach, 1.0)
    margin = int(half.max() + 0.5) + 1
    energy = np.square(np.pad(columns, ((margin, margin), (0, 0)), mode="edge"))
    total = np.zeros((len(energy) + 1, columns.shape[1]), dtype=np.float32)
    np.cumsum(energy, axis=0, out=total[1:])
    out = columns.copy()
    whole = np.floor(half + 0.5).astype(np.int64)
    part = (half + 0.5 - whole).astype(np.float32)
    ends = np.flatnonzero(np.diff(whole, prepend=-1, append=-1))
    # The columns of a run average over the same rows.
    for run in (slice(first, end) for first, end in pairwise(ends) if whole[first] > 0):
        far, near = margin + int(whole[run.start]), margin + 1 - int(whole[run.start])
        above, below = total[:, run], part[run]
        n = len(columns)
        summed = above[far : far + n] - above[near : near + n]
        summed += below * (energy[far : far + n, run] + energy[near - 1 : near - 1 + n, run])
        summed /= (2.0 * half[run]).astype(np.float32)
        out[:, run] = np.sqrt(np.maximum(summed, 0.0))  # rounding may make the difference of two sums negative
    return out
