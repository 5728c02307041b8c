"""Timing of several calls side by side."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True)
class Timing:
    """Time of a call in seconds."""

    median: float  # median over all rounds
    spread: float  # half the distance between the quartiles, as a share of the median


def time_calls(
    calls: Mapping[Key, Callable[[], object]],
    *,
    rounds: int = 7,
    seconds: float = math.inf,
    clock: Callable[[], float] = perf_counter,
    progress: Callable[[float], None] = lambda share: None,
) -> dict[Key, Timing]:
    """Time several calls in turns, so that other load on the machine affects all of them equally."""
    for call in calls.values():
        call()
        progress(0.0)
    taken: dict[Key, list[float]] = {name: [] for name in calls}
    began = perf_counter()
    for turn in range(max(rounds, 3)):
        if turn >= 3 and perf_counter() - began > seconds:
            break
        for number, (name, call) in enumerate(calls.items(), 1):
            start = clock()
            call()
            taken[name].append(clock() - start)
            progress((turn + number / len(calls)) / max(rounds, 3))
    return {name: _timing(np.array(times)) for name, times in taken.items()}


def _timing(times: NDArray[np.float64]) -> Timing:
    low, median, high = np.percentile(times, [25, 50, 75])
    return Timing(float(median), float(0.5 * (high - low) / median))
