"""Errors of a record against its reference, displacement of its shadows and echoes, and similarity as pictures.

Errors and displacement are measured on records divided by the flat-bed curve of the scene, so that the strong echoes of
near bins do not dominate.

Theory: docs/theory/error.md.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from insonify.acoustics.flat_bed import ERROR_ALTITUDES, compute_flat_bed_curves, find_first_bin
from insonify.arrays import Floats, Reals
from insonify.kernels.common.types import Poses, SceneArrays

SSIM_COLUMNS = 7
DARK, SHADOW_BINS = 0.1, 8  # share of the median, and length of the run, that make a shadow
LOUD = 4.0  # medians above which an echo stands out
CHANGED = 1.5  # ratio of levels with targets and without from which a bin belongs to targets or their shadows
LOST = 0.25  # share of an echo below which it counts as lost
WINDOW, MAX_LAG = 8, 96  # bins on either side of an echo, and bins by which it may be displaced


@dataclass(frozen=True)
class RecordErrors:
    """Errors of a record against its reference, both divided by the flat-bed curve; shares, not percent."""

    all_bins: float  # ‖a − b‖ / ‖b‖ over all bins from the first return
    beyond: float  # the same over bins beyond 1.4 times the altitude: the error to which a tolerance refers
    energy_bias: float  # energy of a over energy of b, less 1
    dark_leakage: float  # share of the energy of a in bins where b is 0


def compute_errors(a: Reals, b: Reals, curve: Reals, *, first_bin: int, beyond_bin: int) -> RecordErrors:
    """Compute the errors of a record against its reference, given the flat-bed curve."""
    one, other = (each[..., first_bin:] for each in _divide(np.asarray(curve, dtype=np.float64), a, b))
    start = max(beyond_bin - first_bin, 0)
    return RecordErrors(
        all_bins=_ratio(float(np.linalg.norm(one - other)), float(np.linalg.norm(other))),
        beyond=_ratio(
            float(np.linalg.norm(one[..., start:] - other[..., start:])), float(np.linalg.norm(other[..., start:]))
        ),
        energy_bias=_ratio(float(one.sum() - other.sum()), float(other.sum())),
        dark_leakage=_ratio(float(one[other == 0.0].sum()), float(one.sum())),
    )


def compare_records(arrays: SceneArrays, poses: Poses, a: Reals, b: Reals) -> RecordErrors:
    """Compute the errors of a record of some poses against its reference, by the flat-bed curve of each ping."""
    return compute_errors(
        a,
        b,
        compute_flat_bed_curves(arrays, poses),
        first_bin=find_first_bin(1.0, arrays, poses),
        beyond_bin=find_first_bin(ERROR_ALTITUDES, arrays, poses),
    )


def _ratio(part: float, whole: float) -> float:
    if whole > 0.0:
        return part / whole
    return 0.0 if part == 0.0 else math.copysign(math.inf, part)


class ErrorParts(NamedTuple):
    """Parts of an error, as shares of the record; their squares add up to the square of the whole error."""

    bed: float  # of bins that targets do not change
    shadows: float  # of bins that targets darken
    targets: float  # of bins that targets brighten


def split_error(arrays: SceneArrays, poses: Poses, a: Reals, b: Reals, bare: Reals) -> ErrorParts:
    """Split the error beyond 1.4 times the altitude of a record against its reference, given that without targets."""
    beyond = find_first_bin(ERROR_ALTITUDES, arrays, poses)
    records = _divide(compute_flat_bed_curves(arrays, poses), a, b, bare)
    one, other, without = (each[..., beyond:] for each in records)
    shadow, target = other < without / CHANGED, other > CHANGED * without
    whole = float(np.linalg.norm(other))
    parts = (~(shadow | target), shadow, target)
    return ErrorParts(*(_ratio(float(np.linalg.norm((one - other)[part])), whole) for part in parts))


def _divide(curve: Reals, *records: Reals) -> list[Floats]:
    """Divide records by a flat-bed curve."""
    level = np.broadcast_to(curve, np.shape(records[0]))
    scale = np.divide(1.0, level, out=np.zeros_like(level), where=level > 0.0)
    return [np.asarray(record, dtype=np.float64) * scale for record in records]


def measure_similarity(a: Reals, b: Reals) -> float:
    """Structural similarity (SSIM) of two pictures of records along the range; 1 for equal pictures."""
    # lazy: slow to import
    from skimage.metrics import structural_similarity

    from insonify.display.picture import choose_contrast, map_tones

    levels = choose_contrast(np.asarray(b, dtype=np.float32))
    one, other = (map_tones(np.asarray(each, dtype=np.float32), levels).reshape(-1, np.shape(b)[-1]) for each in (a, b))
    if one.shape[-1] < SSIM_COLUMNS:
        return float((one == other).all())
    compared = structural_similarity(one, other, win_size=SSIM_COLUMNS, channel_axis=0, data_range=255)  # type: ignore[no-untyped-call]  # of scikit-image
    return float(compared)


@dataclass(frozen=True)
class Displacement:
    """Displacement in slant range of the shadows and echoes of a record against its reference, in metres."""

    # Mean distance between the edges of shadows in the reference and in the record; NaN without shadows.
    shadow_edge: float
    echo: float  # mean distance between echoes that stand out from the bed; NaN without such echoes
    lost: int = 0  # echoes that stand out in the reference and are missing in the record; they have no distance


def measure_displacement(arrays: SceneArrays, poses: Poses, a: Reals, b: Reals) -> Displacement:
    """Measure how far a record displaces the shadows and echoes of its reference."""
    beyond = find_first_bin(ERROR_ALTITUDES, arrays, poses)
    records = _divide(compute_flat_bed_curves(arrays, poses), a, b)
    sides = [one.reshape(-1, arrays.bins)[:, beyond:] for one in records]
    edges = [moved for one, other in zip(*sides) for moved in find_edge_shifts(one, other)]
    echoes = [moved for one, other in zip(*sides) for moved in find_echo_shifts(one, other)]
    found = [moved for moved in echoes if not math.isnan(moved)]
    edge, echo = (arrays.bin_length * np.abs(each).mean() if each else math.nan for each in (edges, found))
    return Displacement(float(edge), float(echo), len(echoes) - len(found))


def find_edge_shifts(a: Reals, b: Reals) -> list[float]:
    """Bins by which a record displaces the edges of its reference's shadows."""
    # A shadow is a run of at least `SHADOW_BINS` bins darker than `DARK` times the median of the bins with an echo. Its
    # edge is where a record, from the middle of the shadow outwards, first rises to half of the reference's level just
    # outside, interpolated between bin centres. Where a record has no shadow at all, the edge is the middle itself.
    lit = b[b > 0.0]
    if lit.size == 0:
        return []
    dark = np.concatenate([[False], b < DARK * np.median(lit), [False]])
    begins, ends = np.flatnonzero(dark[1:] & ~dark[:-1]), np.flatnonzero(~dark[1:] & dark[:-1])
    shifts = []
    for begin, end in zip(begins, ends):
        if end - begin < SHADOW_BINS:
            continue
        middle = (begin + end) // 2
        if begin >= 2:
            half = 0.5 * float(b[begin - 2 : begin].max())
            shifts.append(_rise(b[middle::-1], half) - _rise(a[middle::-1], half))
        if end <= b.size - 2:
            half = 0.5 * float(b[end : end + 2].max())
            shifts.append(_rise(a[middle:], half) - _rise(b[middle:], half))
    return shifts


def _rise(levels: Reals, threshold: float) -> float:
    """Fractional index at which levels first reach a threshold, interpolated linearly; the last index if never."""
    reached = np.flatnonzero(levels >= threshold)
    if reached.size == 0:
        return float(levels.size - 1)
    k = int(reached[0])
    return k - (levels[k] - threshold) / (levels[k] - levels[k - 1]) if k > 0 else 0.0


def find_echo_shifts(a: Reals, b: Reals) -> list[float]:
    """Bins by which a record displaces the echoes that stand out in its reference."""
    # An echo stands out where the reference exceeds `LOUD` times the median of the bins with an echo and is the maximum
    # within `WINDOW` bins. That window slides along the record by up to `MAX_LAG` bins to the maximum of the normalised
    # correlation; the difference of the centroids there adds the fraction of a bin. The echo counts as lost where the
    # record stays below `LOUD` / 2 medians or below `LOST` times the echo.
    lit = b[b > 0.0]
    if lit.size == 0:
        return []
    loud = LOUD * float(np.median(lit))
    from scipy.ndimage import maximum_filter1d  # lazy: slow to import

    highest = maximum_filter1d(b, 2 * WINDOW + 1, mode="constant")
    peaks = np.flatnonzero((b == highest) & (b > loud))
    around = np.arange(-WINDOW, WINDOW + 1)
    padded = np.pad(np.asarray(a, dtype=np.float64), WINDOW + MAX_LAG)
    lags = np.arange(-MAX_LAG, MAX_LAG + 1)
    shifts = []
    for peak in peaks[(peaks >= WINDOW) & (peaks < b.size - WINDOW)]:
        window = np.asarray(b[peak - WINDOW : peak + WINDOW + 1], dtype=np.float64)
        slid = sliding_window_view(padded[peak : peak + 2 * (WINDOW + MAX_LAG) + 1], window.size)
        norms = np.linalg.norm(slid, axis=1)
        match = np.divide(slid @ window, norms, out=np.zeros_like(norms), where=norms > 0.0)
        # The smallest lag among equal maxima.
        best = min(np.flatnonzero(match == match.max()), key=lambda k: abs(int(lags[k])))
        there = slid[best]
        if there.max() < max(0.5 * loud, LOST * window.max()):
            shifts.append(math.nan)
            continue
        shifts.append(float(lags[best] + there @ around / there.sum() - window @ around / window.sum()))
    return shifts
