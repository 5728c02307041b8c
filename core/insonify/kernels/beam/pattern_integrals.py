"""Integrals of a beam pattern over the sine s of the angle from athwart, read from tables by row of slant range.

Theory: docs/theory/beam.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.compiler.jit import inlined_uncounted

HALF_OCTAVE = np.float64(math.sqrt(0.5)).view(np.int64)  # bits of 1/√2, which part exponent from mantissa
PER_LN2 = 2.0 / math.log(2.0)


@inlined_uncounted
def integrated_response(centre, extent, integral, first_range, per_octave, s_low, s_high, r):
    """Integral of the two-way response over s between two values, at one slant range.

    The arguments are the pattern's arrays: unpacking its tuple costs more than reading the table.
    """
    row, share = row_of_range(extent, first_range, per_octave, r)
    return response_between(centre, extent, integral, row, share, s_low, s_high)[0]


@inlined_uncounted
def response_between(centre, extent, integral, row, share, s_low, s_high):
    """Integral of the two-way response over s between two values, at a row of the table, and the response at both."""
    low, at_low = _integral_up_to(centre, extent, integral, row, s_low)
    high, at_high = _integral_up_to(centre, extent, integral, row, s_high)
    value = high - low
    if extent.size > 1:
        low, next_low = _integral_up_to(centre, extent, integral, row + 1, s_low)
        high, next_high = _integral_up_to(centre, extent, integral, row + 1, s_high)
        value += share * (high - low - value)
        at_low += share * (next_low - at_low)
        at_high += share * (next_high - at_high)
    return value, at_low, at_high


@inlined_uncounted
def _integral_up_to(centre, extent, integral, row, s):
    """Integral of one row up to a value of s, beyond the table and for NaN up to its end; and its slope there."""
    half, last = extent[np.uint64(row)], integral.shape[1] - 1.0
    scale = last / (2.0 * half)
    wanted = (s - centre + half) * scale
    place = wanted if wanted > 0.0 else 0.0
    place = place if place < last else last
    k = int(place if place < last - 1.0 else last - 1.0)
    # Indices that cannot be negative: loops over knots become vector code.
    before, after = integral[np.uint64(row), np.uint64(k)], integral[np.uint64(row), np.uint64(k + 1)]
    rise = after - before
    return before + (place - k) * rise, rise * scale if place == wanted else 0.0


@inlined_uncounted
def row_of_range(extent, first_range, per_octave, r):
    """Row for a slant range and the fraction of the way to the next row."""
    if extent.size == 1:
        return 0, 0.0
    place = place_in_rows(extent.size - 1.0, first_range, per_octave, r)
    row = row_below(place, extent.size - 1.0)
    return row, place - row


@inlined_uncounted
def place_in_rows(last, first_range, per_octave, r):
    """Fractional row for a slant range; the first one for NaN."""
    ratio = r * (1.0 / first_range)
    place = _octaves(ratio if ratio > 1.0 else 1.0) * per_octave
    return place if place < last else last


@inlined_uncounted
def row_below(place, last):
    """Row below a fractional row, the last but one at most."""
    return int(place if place < last - 1.0 else max(last - 1.0, 0.0))


@inlined_uncounted
def _octaves(ratio):
    """Binary logarithm of a positive number, to 1e-9, in a form that vectorises."""
    bits = np.float64(ratio).view(np.int64)
    whole = (bits - HALF_OCTAVE) >> np.int64(52)
    mantissa = np.int64(bits - (whole << np.int64(52))).view(np.float64)
    # log₂ m = 2 artanh((m − 1) / (m + 1)) / ln 2, by its series for 1/√2 <= m < √2.
    t = (mantissa - 1.0) / (mantissa + 1.0)
    squared = t * t
    series = 1.0 / 3.0 + squared * (1.0 / 5.0 + squared * (1.0 / 7.0 + squared * (1.0 / 9.0)))
    return whole + t * (1.0 + squared * series) * PER_LN2
