"""Range bins whose echoes the pulse brings into one pixel, and their weights."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.pulses import Taps
from insonify.acoustics.resolution_cell import bin_centres
from insonify.kernels.common.types import SONAR, SceneArrays
from insonify.kernels.labels.echo_parts import Window


class PixelWindow(NamedTuple):
    """Bins that echo in one pixel."""

    # Weights of each bin: share that the pulse brings into the pixel; the same with spreading; and with
    # absorption.
    window: Window
    near: float  # slant ranges between which they lie, m
    far: float


def pixel_window(arrays: SceneArrays, taps: Taps, pixel: int) -> PixelWindow:
    """Range bins whose echoes the pulse brings into a pixel."""
    late = np.arange(taps.weights.size) - taps.before
    # Beyond the last bin the echo goes on at its last value, as in the receiver.
    source = np.minimum(pixel - late, arrays.bins - 1)
    within = source >= 0
    first, last = int(source[within].min()), int(source[within].max())
    share = np.zeros(last - first + 1)
    np.add.at(share, source[within] - first, taps.weights[within])
    return _weigh(arrays, first, share)


def whole_window(arrays: SceneArrays) -> PixelWindow:
    """All range bins of one side, each as loud as it is."""
    return _weigh(arrays, 0, np.ones(arrays.bins))


def _weigh(arrays: SceneArrays, first: int, share: NDArray[np.float64]) -> PixelWindow:
    bins = slice(first, first + share.size)
    r = bin_centres(arrays)[bins]
    spreading = r**-4.0 if arrays.law == SONAR else np.ones(r.size)
    weights = np.stack([share, share * spreading, share * arrays.range_factor[bins]])
    length = arrays.bin_length
    return PixelWindow(Window(first, weights), first * length, (first + share.size) * length)
