"""Pixels of a record: display columns, colours, and round values for rulers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray


def column_means(amplitude: NDArray[np.float32], width: int) -> NDArray[np.float32]:
    """Average bins into display columns, or repeat them where there are more columns than bins.

    Parameters
    ----------
    amplitude : (n, bins) float32
        Rows of a record.
    width : int
        Display columns.

    Returns
    -------
    (n, width) float32
        Means; every bin counts in one column, so that no echo is lost.
    """
    bins = amplitude.shape[1]
    edges = np.arange(width + 1) * bins // width
    if width >= bins:
        return np.ascontiguousarray(amplitude[:, edges[:-1]])
    sums = np.add.reduceat(amplitude, edges[:-1], axis=1)
    return np.asarray(sums / np.diff(edges).astype(np.float32), dtype=np.float32)


def colour_table(palette: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """Pack a palette of (256, 3) bytes into (256,) words 0xffRRGGBB."""
    red, green, blue = palette.astype(np.uint32).T
    return np.asarray(0xFF000000 | red << 16 | green << 8 | blue, dtype=np.uint32)


def colours(amplitude: NDArray[np.float32], low: float, high: float, table: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Colour amplitudes; ``low`` takes the first colour of the table, ``high`` the last."""
    scale = 255.0 / max(high - low, 1e-30)
    index = (amplitude - np.float32(low)) * np.float32(scale)
    return np.asarray(table[np.clip(index, 0.0, 255.0).astype(np.uint8)])


def dimmed(words: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Colours 0xffRRGGBB at 3/8 of their brightness."""
    quarter, eighth = (words >> 2) & 0x3F3F3F, (words >> 3) & 0x1F1F1F
    return np.asarray(0xFF000000 | (quarter + eighth), dtype=np.uint32)


def round_steps(low: float, high: float, most: int) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten between two numbers, in at most ``most`` steps."""
    rough = (high - low) / max(most, 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * unit for unit in (1.0, 2.0, 5.0, 10.0) if power * unit >= rough * (1.0 - 1e-9))
    return [step * k for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]
