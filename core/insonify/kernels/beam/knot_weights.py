"""Weights of one plane's sector of the beam at the knots of a profile.

A pattern is read from its table at some knots only. Between two of them it is a function of the level part of the
direction, whose value and slope are known at both.

Theory: docs/theory/beam.md.
"""

from __future__ import annotations

import numpy as np

from insonify.kernels.beam.azimuth_sector import (
    in_plane_lobe,
    in_plane_response,
    pattern_share,
    top_hat_share,
    top_hat_width,
)
from insonify.kernels.beam.pattern_integrals import place_in_rows, response_between, row_below
from insonify.kernels.common.jit import NOTHING, inlined_uncounted, kernel_on_demand, kernel_uncounted
from insonify.kernels.common.types import EVERY_GRAZING, LIGHT, TABLE

MOST_STEPS = 32  # knots from one at which a pattern is read to the next
# Up to the next one the sector's borders move by less than this share of half the main lobe, and the slant range by
# less than this share of a row of the table.
FINE_SINE, FINE_ROW = 1.0 / 8.0, 1.0
OFF_AXIS = 0.25  # fineness across sidelobes, of that across the main lobe
DOUBLED = 0.4  # of these limits, below which the next step is twice as long
LEAST_HEIGHT = 0.01  # share of a ground range


@inlined_uncounted
def weigh_knots(x, z, r, sector, pattern, law, out):
    """Factor by which a plane's sector multiplies the echo of each knot, as `sector_weight` for one place.

    Parameters
    ----------
    x, z, r : ndarray of float64
        Ground range, height above the sonar and slant range of the knots, m; as many as x has.
    sector : AzimuthSector
    pattern : BeamPattern
    law : int
    out : ndarray
        Takes the factors.
    """
    if sector.tabulated:
        _weigh_pattern(x, z, r, sector, pattern, law, out)
    elif sector.angle == 0.0:
        for i in range(x.size):
            out[i] = 1.0  # a knife
    elif law == LIGHT:
        for i in range(x.size):
            out[i] = top_hat_share(x[i], r[i], sector)
    else:
        for i in range(x.size):
            out[i] = top_hat_width(x[i], r[i], sector)


@kernel_on_demand(NOTHING)
def _weigh_pattern(x, z, r, sector, pattern, law, out):
    """Weights of a tabulated pattern, along the track and in the plane."""
    if sector.angle == 0.0:
        for i in range(x.size):
            out[i] = 1.0
    else:
        sample_pattern(x, z, r, sector, pattern, law, out)
        if law != LIGHT:
            _apply_ranges(x, r, sector, out)
    if pattern.vertical == TABLE:
        for i in range(x.size):
            out[i] *= in_plane_response(x[i] / r[i], z[i] / r[i], sector, pattern)
    elif pattern.vertical != EVERY_GRAZING:
        for i in range(x.size):
            out[i] *= in_plane_lobe(x[i] / r[i], z[i] / r[i], sector, pattern)


@kernel_uncounted
def sample_pattern(x, z, r, sector, pattern, law, out):
    """Integral of a pattern over the sines of a sector's directions, or of law LIGHT its share of the beam, at knots.

    Parameters
    ----------
    x, z, r : ndarray of float64
        Ground range, height above the sonar and slant range of the knots, m; as many as x has.
    sector : AzimuthSector
        Of a width.
    pattern : BeamPattern
    law : int
    out : ndarray
        Takes the integrals or the shares. They are read at knots between which the
        sector's borders and the slant range move by little; between them they follow the cosine of the launch angle.
    """
    centre, extent, integral = pattern.centre, pattern.extent, pattern.integral
    first_range, per_octave, last_row = pattern.first_range, pattern.per_octave, extent.size - 1.0
    farther = max(abs(sector.s_low), abs(sector.s_high))
    level = tip = off = place = value = rate = 0.0
    i, steps = -1, 1
    while i < x.size - 1:
        k, last_level, last_tip, last_off, last_place = i + steps, level, tip, off, place
        per_range = 1.0 / r[k]
        level, tip = sector.ahead_level * x[k] * per_range, sector.ahead_up * z[k] * per_range
        s_low, s_high = level * sector.s_low + tip, level * sector.s_high + tip
        place = place_in_rows(last_row, first_range, per_octave, r[k]) if last_row > 0.0 else 0.0
        row = row_below(place, last_row)
        off = max(s_low - centre, centre - s_high, 0.0)
        fine = _samples_per_sine(min(off, last_off), sector.s_beam, extent[np.uint64(row)])
        moved = (abs(level - last_level) * farther + abs(tip - last_tip)) * fine
        moved = max(moved, abs(place - last_place) * (1.0 / FINE_ROW))
        # NaN, a hole in the bed, compares false.
        if steps > 1 and not moved <= 1.0:
            steps, level, tip, off, place = steps >> 1, last_level, last_tip, last_off, last_place
            continue
        last_value, last_rate = value, rate
        value, at_low, at_high = response_between(centre, extent, integral, row, place - row, s_low, s_high)
        # Level and upward part of a direction lie on a circle, so that one is a function of the other.
        rate = at_high * sector.s_high - at_low * sector.s_low
        if sector.ahead_up != 0.0:
            rate -= (at_high - at_low) * sector.ahead_up / sector.ahead_level * x[k] / _away_from_zero(z[k], x[k])
        if law == LIGHT:
            share = pattern_share(x[k], z[k], r[k], sector, pattern)
            value, rate = share, rate * share / value if value > 0.0 else 0.0
        if steps > 1:
            chord = last_level, level - last_level, last_value, value - last_value, last_rate, rate - last_rate
            first, beyond = i + 1, k + 1
            _fill_chord(x[first:beyond], r[first:beyond], sector.ahead_level, chord, out[first:beyond])
        out[k] = value
        i = k
        # Branches, which are predicted: a number of steps computed from the last ones would have to be waited for.
        if moved < DOUBLED and x[k] > 0.0 and steps < MOST_STEPS:
            steps *= 2
        if steps > x.size - 1 - k:
            steps = max(x.size - 1 - k, 1)


@inlined_uncounted
def _away_from_zero(height, x):
    """Height of a place above the sonar, or a small one below where it is about as high."""
    return height if abs(height) > LEAST_HEIGHT * x else -LEAST_HEIGHT * x


@inlined_uncounted
def _samples_per_sine(off, main, extent):
    """Return the samples of a pattern per change of s, where the nearer border of a sector is so far off the axis."""
    if off > extent:
        return 0.0
    return (1.0 if off < main else OFF_AXIS) / (FINE_SINE * main)


@inlined_uncounted
def _fill_chord(x, r, ahead_level, chord, out):
    """Fill the knots up to one at which a function of a direction's level part is known, as it is at the last such one.

    To the second order it is the chord, a parabola, and its slope times what the level part is off its own chord.
    """
    level, levels, value, values, rate, rates = chord
    per_step, bend = 1.0 / x.size, 0.5 * rates * levels
    for m in range(x.size):
        t = (m + 1.0) * per_step
        off_chord = ahead_level * x[m] / r[m] - level - t * levels
        filled = value + t * (values + (t - 1.0) * bend) + (rate + t * rates) * off_chord
        out[m] = filled if filled > 0.0 else 0.0


@inlined_uncounted
def _apply_ranges(x, r, sector, out):
    """Along-track width of a sector from the integral of the pattern over its sines, as `pattern_width`."""
    span = sector.ahead_level * (sector.s_high - sector.s_low)
    real, per_sine = out.dtype.type, sector.angle / span if span > 0.0 else 0.0
    for i in range(x.size):
        out[i] = out[i] * real(r[i] * per_sine) if x[i] > 0.0 else real(0.0)
