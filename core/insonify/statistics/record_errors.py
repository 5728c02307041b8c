"""Errors of a record against its reference, as used by tolerances and charts, and similarity as pictures.

Both records are divided by the flat-bed curve of the scene, so that the strong echoes of near bins do not dominate.

Theory: docs/theory/error.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.flat_bed import ERROR_ALTITUDES, compute_flat_bed_curves, find_first_bin
from insonify.kernels.common.types import Poses, SceneArrays

SSIM_COLUMNS = 7


@dataclass(frozen=True)
class RecordErrors:
    """Errors of a record against its reference, both divided by the flat-bed curve; shares, not percent."""

    all_bins: float  # ‖a − b‖ / ‖b‖ over all bins from the first return
    beyond: float  # the same over bins beyond 1.4 times the altitude: the error to which a tolerance refers
    energy_bias: float  # energy of a over energy of b, less 1
    dark_leakage: float  # share of the energy of a in bins where b is 0


def compute_errors(
    a: NDArray[np.floating],
    b: NDArray[np.floating],
    curve: NDArray[np.floating],
    *,
    first_bin: int,
    beyond_bin: int,
) -> RecordErrors:
    """Compute the errors of a record against its reference, given the flat-bed curve."""
    level = np.broadcast_to(np.asarray(curve, dtype=np.float64), np.shape(b))[..., first_bin:]
    scale = np.divide(1.0, level, out=np.zeros_like(level), where=level > 0.0)
    one = np.asarray(a, dtype=np.float64)[..., first_bin:] * scale
    other = np.asarray(b, dtype=np.float64)[..., first_bin:] * scale
    start = max(beyond_bin - first_bin, 0)
    return RecordErrors(
        all_bins=_ratio(float(np.linalg.norm(one - other)), float(np.linalg.norm(other))),
        beyond=_ratio(
            float(np.linalg.norm(one[..., start:] - other[..., start:])), float(np.linalg.norm(other[..., start:]))
        ),
        energy_bias=_ratio(float(one.sum() - other.sum()), float(other.sum())),
        dark_leakage=_ratio(float(one[other == 0.0].sum()), float(one.sum())),
    )


def compare_records(
    arrays: SceneArrays, poses: Poses, a: NDArray[np.floating], b: NDArray[np.floating]
) -> RecordErrors:
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


def measure_similarity(a: NDArray[np.floating], b: NDArray[np.floating]) -> float:
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
