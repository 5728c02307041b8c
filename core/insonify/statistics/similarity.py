"""Similarity of two records as pictures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from skimage import metrics

from insonify.display.picture import choose_contrast, map_tones

SSIM_COLUMNS = 7

_compare: Callable[..., float] = metrics.structural_similarity


def measure_similarity(a: NDArray[np.floating], b: NDArray[np.floating]) -> float:
    """Structural similarity (SSIM) of two pictures of records along the range; 1 for equal pictures."""
    levels = choose_contrast(np.asarray(b, dtype=np.float32))
    one, other = (map_tones(np.asarray(each, dtype=np.float32), levels).reshape(-1, np.shape(b)[-1]) for each in (a, b))
    if one.shape[-1] < SSIM_COLUMNS:
        return float((one == other).all())
    return float(_compare(one, other, win_size=SSIM_COLUMNS, channel_axis=0, data_range=255))
