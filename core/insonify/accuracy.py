"""How far one record is from another, what to trust as right, and how long a ping takes."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.types import Poses, Problem
from insonify.sound.flat_bed import flat_bed_curve
from insonify.tracers import rays

Name = TypeVar("Name", bound=Hashable)
BEYOND = 1.4  # altitudes; an error counts from there
FIRST_RAYS = 1 << 15
MOST_RAYS = 1 << 22


@dataclass(frozen=True)
class Errors:
    """How a record differs from its reference, both divided by the flat bed's curve; shares, not percent.

    Attributes
    ----------
    all_bins : float
        ‖a − b‖ / ‖b‖ over all bins from the first return.
    beyond : float
        The same over bins beyond 1.4 times the altitude: the error that a tolerance means.
    energy_bias : float
        Share by which a's energy is above b's.
    dark_leakage : float
        Share of a's energy in bins where b has none.
    """

    all_bins: float
    beyond: float
    energy_bias: float
    dark_leakage: float


def record_error(
    a: NDArray[np.floating],
    b: NDArray[np.floating],
    curve: NDArray[np.floating],
    *,
    first_bin: int,
    beyond_bin: int,
) -> Errors:
    """Compare a record with its reference.

    Parameters
    ----------
    a, b : (..., bins) float
        Record and reference.
    curve : (bins,) or (..., bins) float
        Of the flat bed; bins where it is zero do not count.
    first_bin, beyond_bin : int
        First bin of the first return, first bin beyond 1.4 times the altitude.

    Returns
    -------
    Errors
        Zero if nothing is heard in either, infinite if only the reference is silent.
    """
    level = np.broadcast_to(np.asarray(curve, dtype=np.float64), np.shape(b))[..., first_bin:]
    scale = np.divide(1.0, level, out=np.zeros_like(level), where=level > 0.0)
    one = np.asarray(a, dtype=np.float64)[..., first_bin:] * scale
    other = np.asarray(b, dtype=np.float64)[..., first_bin:] * scale
    start = max(beyond_bin - first_bin, 0)
    return Errors(
        all_bins=_ratio(float(np.linalg.norm(one - other)), float(np.linalg.norm(other))),
        beyond=_ratio(
            float(np.linalg.norm(one[..., start:] - other[..., start:])), float(np.linalg.norm(other[..., start:]))
        ),
        energy_bias=_ratio(float(one.sum() - other.sum()), float(other.sum())),
        dark_leakage=_ratio(float(one[other == 0.0].sum()), float(one.sum())),
    )


def compare(problem: Problem, poses: Poses, a: NDArray[np.floating], b: NDArray[np.floating]) -> Errors:
    """Compare a record of some poses with its reference, by the flat bed's curve of each ping.

    Parameters
    ----------
    problem : Problem
        Whose record it is.
    poses : Poses
        Of its n pings.
    a, b : (n, 2, bins) float
        Record and reference.

    Returns
    -------
    Errors
    """
    highest = float(poses.z.max(initial=0.0))
    return record_error(
        a,
        b,
        flat_bed_curves(problem, poses),
        first_bin=min(math.ceil(highest / problem.bin_length), problem.bins),
        beyond_bin=min(math.ceil(BEYOND * highest / problem.bin_length), problem.bins),
    )


def flat_bed_curves(problem: Problem, poses: Poses) -> NDArray[np.float64]:
    """Return the record of a level bed under every pose, (n, 1, bins) float64."""
    altitudes, which = np.unique(poses.z, return_inverse=True)
    curves = np.array([flat_bed_curve(problem, float(altitude)) for altitude in altitudes])
    return curves.reshape(-1, problem.bins)[which][:, None, :]


def reference(problem: Problem, poses: Poses, *, tolerance: float) -> tuple[NDArray[np.float32], float]:
    """Trace ray by ray with twice as many rays until that moves the record by less than a tolerance.

    Parameters
    ----------
    problem : Problem
        The scene as kernels see it.
    poses : Poses
        Where the sonar is, n pings.
    tolerance : float
        Share of the record, beyond 1.4 times the altitude.

    Returns
    -------
    record : (n, 2, bins) float32
        The last, finest record.
    moved : float
        How far the last doubling moved it; above the tolerance if 4 million rays a side are not enough.
    """
    count = FIRST_RAYS
    record = rays.trace(problem, poses, rays=count)
    moved = math.inf
    while moved >= tolerance and count < MOST_RAYS:
        count *= 2
        finer = rays.trace(problem, poses, rays=count)
        moved = compare(problem, poses, record, finer).beyond
        record = finer
    return record, moved


@dataclass(frozen=True)
class Timing:
    """Seconds that a call takes.

    Attributes
    ----------
    median : float
        Over all rounds.
    spread : float
        Half the distance between the quartiles, as a share of the median.
    """

    median: float
    spread: float


def time_calls(
    calls: Mapping[Name, Callable[[], object]], *, rounds: int = 7, seconds: float = math.inf
) -> dict[Name, Timing]:
    """Time several calls in turns, so that what else the machine does falls on all of them alike.

    Parameters
    ----------
    calls : mapping to callable
        What to time, by name; each is called once beforehand, so that nothing is compiled on the clock.
    rounds : int
        Times that each is called, at least 3.
    seconds : float
        After these no further round begins.

    Returns
    -------
    dict to Timing
    """
    for call in calls.values():
        call()
    taken: dict[Name, list[float]] = {name: [] for name in calls}
    began = perf_counter()
    for turn in range(max(rounds, 3)):
        if turn >= 3 and perf_counter() - began > seconds:
            break
        for name, call in calls.items():
            start = perf_counter()
            call()
            taken[name].append(perf_counter() - start)
    return {name: _timing(np.array(times)) for name, times in taken.items()}


def _timing(times: NDArray[np.float64]) -> Timing:
    low, median, high = np.percentile(times, [25, 50, 75])
    return Timing(float(median), float(0.5 * (high - low) / median))


def _ratio(part: float, whole: float) -> float:
    if whole > 0.0:
        return part / whole
    return 0.0 if part == 0.0 else math.copysign(math.inf, part)
