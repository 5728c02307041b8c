"""Timing of several calls side by side, and the machine on which it depends."""

import math
import platform
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import TypeVar

import numpy as np

from insonify.cores import usable_cores

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
    quartiles = {name: np.percentile(times, [25, 50, 75]) for name, times in taken.items()}
    return {name: Timing(float(m), float(0.5 * (high - low) / m)) for name, (low, m, high) in quartiles.items()}


def describe_machine() -> str:
    """Describe the processor, its cores and the versions of the software."""
    parts = (
        _processor(),
        f"{usable_cores()} cores, one thread used",
        platform.system(),
        f"Python {platform.python_version()}",
        f"Numba {version('numba')}",
        f"insonify {version('insonify')}",
    )
    return ", ".join(parts)


def _processor() -> str:
    """Name of the processor by the operating system."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
