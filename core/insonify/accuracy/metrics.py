"""How far one record is from another, what to trust as right, and how long a ping takes."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import TypeVar

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from insonify.acoustics.flat_bed import flat_bed_curve
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.tracers import rays

Name = TypeVar("Name", bound=Hashable)
BEYOND = 1.4  # altitudes; an error counts from there
DARK, SHADOW = 0.1, 8  # of the median, and bins in a row: a shadow
LOUD = 4.0  # medians; an echo that stands out
LOST = 0.25  # of an echo, less than which is none
ABOUT, FARTHEST = 8, 96  # bins about an echo, and those by which it is looked for
SSIM_COLUMNS = 7
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


def compare(arrays: SceneArrays, poses: Poses, a: NDArray[np.floating], b: NDArray[np.floating]) -> Errors:
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
        flat_bed_curves(arrays, poses),
        first_bin=min(math.ceil(highest / arrays.bin_length), arrays.bins),
        beyond_bin=min(math.ceil(BEYOND * highest / arrays.bin_length), arrays.bins),
    )


@dataclass(frozen=True)
class Displacement:
    """How far what a record shows lies from where its reference has it, in metres of slant range.

    Attributes
    ----------
    shadow_edge : float
        Mean distance between the edges of the reference's shadows and the record's; NaN if there are none.
    echo : float
        Likewise between echoes that stand out of the bed's.
    lost : int
        Echoes that stand out of the reference and are nowhere near in the record; these have no distance.
    """

    shadow_edge: float
    echo: float
    lost: int = 0


def displacement(arrays: SceneArrays, poses: Poses, a: NDArray[np.floating], b: NDArray[np.floating]) -> Displacement:
    """Measure how far a record displaces the shadows and echoes of its reference.

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
    Displacement
    """
    curve = np.broadcast_to(flat_bed_curves(arrays, poses), np.shape(b))
    scale = np.divide(1.0, curve, out=np.zeros_like(curve), where=curve > 0.0)
    beyond = min(math.ceil(BEYOND * float(poses.z.max(initial=0.0)) / arrays.bin_length), arrays.bins)
    sides = [one.reshape(-1, arrays.bins)[:, beyond:] for one in (a * scale, b * scale)]
    edges = [moved for one, other in zip(*sides) for moved in edge_shifts(one, other)]
    echoes = [moved for one, other in zip(*sides) for moved in echo_shifts(one, other)]
    found = [moved for moved in echoes if not math.isnan(moved)]
    edge, echo = (arrays.bin_length * _mean_size(shifts) for shifts in (edges, found))
    return Displacement(edge, echo, len(echoes) - len(found))


def edge_shifts(a: NDArray[np.floating], b: NDArray[np.floating]) -> list[float]:
    """Return by how many bins a record displaces the edges of its reference's shadows.

    A shadow is a run of at least `SHADOW` bins all darker than a tenth of the median of what is heard. Its edge is
    where, from its middle outwards, a record first rises to half of what the reference has just outside, between the
    centres of two bins; where a record shows no shadow at all, that is the middle itself.

    Parameters
    ----------
    a, b : (bins,) float
        Record and reference of one side, divided by the flat bed's curve.

    Returns
    -------
    list of float
        Positive away from the sonar; near and far edges, in order.
    """
    heard = b[b > 0.0]
    if heard.size == 0:
        return []
    dark = np.concatenate([[False], b < DARK * np.median(heard), [False]])
    begins, ends = np.flatnonzero(dark[1:] & ~dark[:-1]), np.flatnonzero(~dark[1:] & dark[:-1])
    shifts = []
    for begin, end in zip(begins, ends):
        if end - begin < SHADOW:
            continue
        middle = (begin + end) // 2
        if begin >= 2:
            half = 0.5 * float(b[begin - 2 : begin].max())
            shifts.append(_rise(b[middle::-1], half) - _rise(a[middle::-1], half))
        if end <= b.size - 2:
            half = 0.5 * float(b[end : end + 2].max())
            shifts.append(_rise(a[middle:], half) - _rise(b[middle:], half))
    return shifts


def _rise(levels: NDArray[np.floating], threshold: float) -> float:
    """Bins after which levels first reach a threshold, between two of them by proportion; the last if never."""
    reached = np.flatnonzero(levels >= threshold)
    if reached.size == 0:
        return float(levels.size - 1)
    k = int(reached[0])
    return k - (levels[k] - threshold) / (levels[k] - levels[k - 1]) if k > 0 else 0.0


def echo_shifts(a: NDArray[np.floating], b: NDArray[np.floating]) -> list[float]:
    """Return by how many bins a record displaces those echoes of its reference that stand out.

    An echo stands out where the reference exceeds `LOUD` times the median of what is heard and all else within `ABOUT`
    bins. Its window is slid along the record, up to `FARTHEST` bins either way, to where both agree best by their
    normalised correlation; there the centroids of both tell the parts of a bin. Where nothing in it is half as loud as
    what stands out, or a quarter as loud as the echo, that is lost.

    Parameters
    ----------
    a, b : (bins,) float
        Record and reference of one side, divided by the flat bed's curve.

    Returns
    -------
    list of float
        Positive away from the sonar, in order of range; NaN of those that are lost.
    """
    heard = b[b > 0.0]
    if heard.size == 0:
        return []
    loud = LOUD * float(np.median(heard))
    highest = maximum_filter1d(b, 2 * ABOUT + 1, mode="constant")
    peaks = np.flatnonzero((b == highest) & (b > loud))
    around = np.arange(-ABOUT, ABOUT + 1)
    padded = np.pad(np.asarray(a, dtype=np.float64), ABOUT + FARTHEST)
    lags = np.arange(-FARTHEST, FARTHEST + 1)
    shifts = []
    for peak in peaks[(peaks >= ABOUT) & (peaks < b.size - ABOUT)]:
        window = np.asarray(b[peak - ABOUT : peak + ABOUT + 1], dtype=np.float64)
        slid = sliding_window_view(padded[peak : peak + 2 * (ABOUT + FARTHEST) + 1], window.size)
        norms = np.linalg.norm(slid, axis=1)
        match = np.divide(slid @ window, norms, out=np.zeros_like(norms), where=norms > 0.0)
        # Of equal ones the nearest.
        best = min(np.flatnonzero(match == match.max()), key=lambda k: abs(int(lags[k])))
        there = slid[best]
        if there.max() < max(0.5 * loud, LOST * window.max()):
            shifts.append(math.nan)
            continue
        shifts.append(float(lags[best] + there @ around / there.sum() - window @ around / window.sum()))
    return shifts


def _mean_size(shifts: list[float]) -> float:
    return float(np.abs(shifts).mean()) if shifts else math.nan


def similarity(a: NDArray[np.floating], b: NDArray[np.floating]) -> float:
    """Return how alike two pictures look, by structural similarity along the range: 1 for equal ones.

    Parameters
    ----------
    a, b : (..., columns) float
        Amplitudes as `picture.normalise` has them; shown between the darkest and the brightest that `picture.contrast`
        picks for ``b``. Rows need not be neighbours.

    Returns
    -------
    float
        Wang et al. 2004, mean over all windows of 7 columns.
    """
    from skimage import metrics

    from insonify.display.picture import contrast, tones

    compared: Callable[..., float] = metrics.structural_similarity

    levels = contrast(np.asarray(b, dtype=np.float32))
    one, other = (tones(np.asarray(each, dtype=np.float32), levels).reshape(-1, np.shape(b)[-1]) for each in (a, b))
    if one.shape[-1] < SSIM_COLUMNS:
        return float((one == other).all())
    return float(compared(one, other, win_size=SSIM_COLUMNS, channel_axis=0, data_range=255))


def flat_bed_curves(arrays: SceneArrays, poses: Poses) -> NDArray[np.float64]:
    """Return the record of a level bed under every pose, (n, 1, bins) float64."""
    altitudes, which = np.unique(poses.z, return_inverse=True)
    curves = np.array([flat_bed_curve(arrays, float(altitude)) for altitude in altitudes])
    return curves.reshape(-1, arrays.bins)[which][:, None, :]


def reference(arrays: SceneArrays, poses: Poses, *, tolerance: float) -> tuple[NDArray[np.float32], float]:
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
    record = rays.trace(arrays, poses, rays=count)
    moved = math.inf
    while moved >= tolerance and count < MOST_RAYS:
        count *= 2
        finer = rays.trace(arrays, poses, rays=count)
        moved = compare(arrays, poses, record, finer).beyond
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
    calls: Mapping[Name, Callable[[], object]],
    *,
    rounds: int = 7,
    seconds: float = math.inf,
    clock: Callable[[], float] = perf_counter,
    progress: Callable[[float], None] = lambda share: None,
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
    clock : callable
        Tells seconds: by the wall, or those of this thread alone, so that what else the machine does hardly counts.
    progress : callable
        Called after every call with the share of the rounds done; may raise to stop.

    Returns
    -------
    dict to Timing
    """
    for call in calls.values():
        call()
        progress(0.0)
    taken: dict[Name, list[float]] = {name: [] for name in calls}
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


def _ratio(part: float, whole: float) -> float:
    if whole > 0.0:
        return part / whole
    return 0.0 if part == 0.0 else math.copysign(math.inf, part)
