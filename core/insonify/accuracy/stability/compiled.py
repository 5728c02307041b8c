"""Failures of compiled code: the only Numba functions outside the kernels, to show what a compiler does."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numba import njit, prange
from numpy.typing import NDArray


def mean_of_known(values: NDArray[np.float64]) -> float:
    """Mean of the values that are not NaN."""
    total, count = 0.0, 0
    for k in range(values.size):
        if math.isnan(values[k]):
            continue
        total += values[k]
        count += 1
    return total / count


def guarded_mean(values: NDArray[np.float64], licences: Any) -> float:
    """Compile that mean with licences to take liberties with arithmetic, and call it."""
    return float(njit(fastmath=licences)(mean_of_known)(values))


def root(value: float) -> float:
    """Square root that raises an error for negative numbers."""
    if value < 0.0:
        raise ValueError("negative")
    return math.sqrt(value)


@lru_cache(maxsize=1)
def swallowed() -> float:
    """Percentage of results that are missing, without the error's own word, when a call of a parallel loop raises."""
    compiled = njit(root)

    @njit(parallel=True)
    def roots(values: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        for k in prange(values.size):
            out[k] = compiled(values[k])  # type: ignore[call-overload]

    values, out = np.ones(10_000), np.full(10_000, np.nan)
    values[-1000] = -1.0
    try:
        roots(values, out)
    except ValueError:
        return 0.0
    except SystemError:
        pass  # the caller's own thread had that share: it stops, but not by the error that was raised
    return float(100.0 * np.isnan(out).mean())
