"""Integrals of a beam pattern over the sine s of the angle from athwart, read from tables by row of slant range.

Theory: docs/theory/beam.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.common.jit import inlined_uncounted, kernel_uncounted

HALF_OCTAVE = np.float64(math.sqrt(0.5)).view(np.int64)  # bits of 1/√2, which part exponent from mantissa
PER_LN2 = 2.0 / math.log(2.0)


@inlined_uncounted
def integrated_response(centre, extent, integral, first_range, per_octave, s_low, s_high, r):
    """Integral of the two-way response over s between two values, at one slant range.

    The arguments are the pattern's arrays: unpacking its tuple costs more than reading the table.

    Parameters
    ----------
    centre, extent, integral, first_range, per_octave
        Of the BeamPattern.
    s_low, s_high : float
        Sines of the angles from the plane athwart the fish.
    r : float
        Slant range, m.

    Returns
    -------
    float
    """
    row, share = row_of_range(extent, first_range, per_octave, r)
    response = _step(centre, extent, integral, row, s_low, s_high)
    if extent.size > 1:
        response += share * (_step(centre, extent, integral, row + 1, s_low, s_high) - response)
    return response


@inlined_uncounted
def _step(centre, extent, integral, row, s_low, s_high):
    """Difference of one row's integral between two values of s."""
    half, last = extent[np.uint64(row)], integral.shape[1] - 1.0
    scale = last / (2.0 * half)
    low, high = (s_low - centre + half) * scale, (s_high - centre + half) * scale
    return _integral_at(integral, row, high, last) - _integral_at(integral, row, low, last)


@kernel_uncounted
def integrated_responses(x, z, r, axis, borders, centre, extent, integral, first_range, per_octave, out):
    """Integral of the two-way response over s between two azimuths, at many places of one plane.

    Parameters
    ----------
    x, z, r : ndarray of float64, shape (n,)
        Ground ranges, heights above the sonar and slant ranges of the places, m.
    axis : tuple of two float
        Level part of the fish's axis, and its part upwards.
    borders : tuple of two float
        Sines of the azimuths.
    centre, extent, integral, first_range, per_octave
        Of the BeamPattern.
    out : ndarray of float
        Takes the integrals, n or more.
    """
    last_row, last = extent.size - 1.0, integral.shape[1] - 1.0
    for i in range(x.size):  # a pass of its own becomes vector code
        out[i] = _fractional_row(last_row, first_range, per_octave, r[i])
    held, half, scale, next_half, next_scale = -1, 1.0, 1.0, 1.0, 1.0
    for i in range(x.size):
        place, per_range = np.float64(out[i]), 1.0 / r[i]
        row = _row_below(place, last_row)
        if row != held:
            # Neighbouring knots mostly share a row.
            held, half, next_half = row, extent[row], extent[min(row + 1, extent.size - 1)]
            scale, next_scale = last / (2.0 * half), last / (2.0 * next_half)
        tip = axis[1] * z[i] * per_range - centre
        low, high = axis[0] * x[i] * per_range * borders[0] + tip, axis[0] * x[i] * per_range * borders[1] + tip
        response = _integral_at(integral, row, (high + half) * scale, last)
        response -= _integral_at(integral, row, (low + half) * scale, last)
        if extent.size > 1:
            beyond = _integral_at(integral, row + 1, (high + next_half) * next_scale, last)
            beyond -= _integral_at(integral, row + 1, (low + next_half) * next_scale, last)
            response += (place - row) * (beyond - response)
        out[i] = response


@inlined_uncounted
def _integral_at(integral, row, place, last):
    """Integral of one row up to a fractional column; beyond the table and for NaN up to its end."""
    place = place if place > 0.0 else 0.0
    place = place if place < last else last
    k = int(place if place < last - 1.0 else last - 1.0)
    # Indices that cannot be negative: loops over knots become vector code.
    before, after = integral[np.uint64(row), np.uint64(k)], integral[np.uint64(row), np.uint64(k + 1)]
    return before + (place - k) * (after - before)


@inlined_uncounted
def row_of_range(extent, first_range, per_octave, r):
    """Row for a slant range and the fraction of the way to the next row.

    Parameters
    ----------
    extent, first_range, per_octave
        Of the BeamPattern.
    r : float
        Slant range, m.

    Returns
    -------
    tuple of int and float
    """
    place = _fractional_row(extent.size - 1.0, first_range, per_octave, r)
    row = _row_below(place, extent.size - 1.0)
    return row, place - row


@inlined_uncounted
def _fractional_row(last, first_range, per_octave, r):
    """Fractional row for a slant range; the first one for NaN."""
    ratio = r * (1.0 / first_range)
    place = _octaves(ratio if ratio > 1.0 else 1.0) * per_octave
    return place if place < last else last


@inlined_uncounted
def _row_below(place, last):
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
