"""Picture of the ratio of two records in dB, on a two-sided palette."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.display.picture import colour_rows
from insonify_viewer.record.comparison.record_difference import FLOOR

SPANS = (0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 40.0)  # dB at the ends of the palette
CLIPPED = 0.005  # share of the pixels that may lie beyond the ends
SAMPLED = 7  # every so many pixels are looked at for the span
Columns = tuple[NDArray[np.float32], NDArray[np.bool_]]


class DifferencePicture(NamedTuple):
    """Ratio of two records."""

    pixels: NDArray[np.uint32]  # (n, width) colours 0xffRRGGBB, newest ping first
    span: float  # decibels at the ends of the palette


def decibels_between(a: Columns, b: Columns, rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """Level of B over A, pixel by pixel."""
    known = (rows >= 0) & (rows < len(a[1])) & b[1]
    known[known] = a[1][rows[known]]
    one, other = a[0][rows[known]], b[0][known]
    ratio = (np.square(other) + np.float32(FLOOR)) / (np.square(one) + np.float32(FLOOR))
    level = np.float32(10.0) * np.log10(ratio)
    level[(one < 0.0) | (other < 0.0)] = np.nan
    out = np.full(b[0].shape, np.nan, dtype=np.float32)
    out[known] = level
    return out


def draw_difference(decibels: NDArray[np.float32], table: NDArray[np.uint32], empty: int) -> DifferencePicture:
    """Colour decibels, with ends that hold all but a few pixels."""
    unknown = np.isnan(decibels)
    sizes = np.abs(decibels.ravel()[::SAMPLED])
    sizes = sizes[np.isfinite(sizes)]
    large = float(np.quantile(sizes, 1.0 - CLIPPED)) if sizes.size else 0.0
    span = next((span for span in SPANS if span >= large), SPANS[-1])
    pixels = colour_rows(np.where(unknown, np.float32(0.0), decibels), -span, span, table)
    pixels[unknown] = empty
    return DifferencePicture(np.ascontiguousarray(pixels), span)
