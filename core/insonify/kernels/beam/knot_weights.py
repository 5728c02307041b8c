"""Weights of one plane's sector of the beam at the knots of a profile.

A pattern is read from its table at some knots only. Between two of them it is a function of the level part of the
direction, whose value and slope are known at both. A top-hat has a closed form, which is taken at every knot.

Theory: docs/theory/beam.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.beam.azimuth_sector import (
    in_plane_lobe,
    in_plane_response,
    is_top_hat,
    paired_width,
    pattern_share,
    top_hat_share,
    top_hat_width,
)
from insonify.kernels.beam.pattern_integrals import place_in_rows, response_between, row_below
from insonify.kernels.common.jit import NOTHING, inlined_uncounted, kernel_on_demand, kernel_uncounted
from insonify.kernels.common.types import EVERY_GRAZING, LIGHT, TABLE

MOST_STEPS = 32  # knots from one at which a pattern is read to the next
# Up to the next one the sector's borders move by less than this share of half the main lobe, on it and on sidelobes,
# and the slant range by less than this share of a row of the table.
FINE_SINE, FINE_ROW = (1.0 / 8.0, 1.0 / 2.0), 1.0 / 2.0
# The same where the root of two responses counts, which is large where one of them is small.
FINE_ROOT = (1.0 / 24.0, 1.0 / 24.0)
FINE_PAIR = 0.02  # share of a slant range, a direction's level part and half the main lobe, for two images
DOUBLED = 0.4  # of these limits, below which the next step is twice as long
LEAST_HEIGHT = 0.01  # share of a ground range


@inlined_uncounted
def weigh_knots(x, z, r, sector, pattern, law, fine, out):
    """Factor by which a plane's sector multiplies the echo of each knot, as `sector_weight` for one place.

    Parameters
    ----------
    x, z, r : ndarray of float64
        Ground range, height above the sonar and slant range of the knots, m; as many as x has.
    sector : AzimuthSector
    pattern : BeamPattern
    law : int
    fine : tuple of two float
        Share of half the main lobe by which a sector may move up to the next knot at which a pattern is read, where it
        meets that lobe and where it does not.
    out : ndarray
        Takes the factors.
    """
    if sector.tabulated:
        _weigh_pattern(x, z, r, sector, pattern, law, fine, out)
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
def _weigh_pattern(x, z, r, sector, pattern, law, fine, out):
    """Weights of a tabulated pattern, along the track and in the plane."""
    if sector.angle == 0.0:
        for i in range(x.size):
            out[i] = 1.0
    elif law == LIGHT:
        for i in range(x.size):
            out[i] = pattern_share(x[i], z[i], r[i], sector, pattern)
    else:
        if is_top_hat(pattern):
            _overlap_top_hat(x, z, r, sector, pattern, out)
        else:
            sample_pattern(x, z, r, sector, pattern, fine, out)
        _apply_ranges(x, r, sector, out)
    if pattern.vertical == TABLE:
        for i in range(x.size):
            out[i] *= in_plane_response(x[i] / r[i], z[i] / r[i], sector, pattern)
    elif pattern.vertical != EVERY_GRAZING:
        for i in range(x.size):
            out[i] *= in_plane_lobe(x[i] / r[i], z[i] / r[i], sector, pattern)


@inlined_uncounted
def _overlap_top_hat(x, z, r, sector, pattern, out):
    """Integral of a top-hat pattern over the sines of a sector's directions: their overlap with the beam."""
    real, half, centre, s_low, s_high = out.dtype.type, pattern.extent[0], pattern.centre, sector.s_low, sector.s_high
    ahead_level, ahead_up, level = sector.ahead_level, sector.ahead_up, 0.5 * pattern.integral[0, 1] / pattern.extent[0]
    for i in range(x.size):
        per_range = 1.0 / r[i]
        athwart, tip = ahead_level * x[i] * per_range, ahead_up * z[i] * per_range - centre
        low, high = athwart * s_low + tip, athwart * s_high + tip
        # NaN, a hole in the bed, compares false.
        low, high = low if low > -half else -half, high if high > -half else -half
        low, high = low if low < half else half, high if high < half else half
        out[i] = real(level * (high - low))


@kernel_uncounted
def weigh_paired_knots(x, one, other, sector, pattern, law, weight):
    """Weigh the knots of a profile by what a plane that stands for a whole beam has of two images, as `paired_weight`.

    Parameters
    ----------
    x : ndarray of float64
        Ground ranges of the knots, m.
    one, other : ImageProfile
        The lower and the higher image.
    sector : AzimuthSector
    pattern : BeamPattern
        Of a beam that sound passes twice.
    law : int
    weight : ndarray
        Takes the weights.
    """
    ranges = one.r
    _sample_pair(x, one, other, sector, pattern, law, weight)
    if law != LIGHT:
        for i in range(x.size):
            weight[i] *= ranges[i]
    if pattern.vertical != EVERY_GRAZING:
        rise, rise_other, ranges_other = one.rise, other.rise, other.r
        for i in range(x.size):
            vertical = in_plane_response(x[i] / ranges[i], rise[i] / ranges[i], sector, pattern)
            vertical *= in_plane_response(x[i] / ranges_other[i], rise_other[i] / ranges_other[i], sector, pattern)
            weight[i] *= math.sqrt(vertical)


@inlined_uncounted
def _sample_pair(x, one, other, sector, pattern, law, out):
    """Sample the width for two images over the lower one's slant range, or the share, at some knots; linear between."""
    level = level_other = tip = tip_other = r = value = 0.0
    i, steps = -1, 1
    while i < x.size - 1:
        k = i + steps
        levels, tips = sector.ahead_level * x[k] / one.r[k], sector.ahead_up * one.rise[k] / one.r[k]
        levels_other, tips_other = sector.ahead_level * x[k] / other.r[k], sector.ahead_up * other.rise[k] / other.r[k]
        moved = max(abs(levels - level) / (levels + sector.s_beam), abs(tips - tip) / sector.s_beam)
        moved = max(moved, abs(levels_other - level_other) / (levels_other + sector.s_beam))
        moved = max(moved, abs(tips_other - tip_other) / sector.s_beam, abs(one.r[k] - r) / one.r[k])
        moved *= 1.0 / FINE_PAIR
        if steps > 1 and not moved <= 1.0:
            steps >>= 1
            continue
        last = value
        value = 0.0
        if x[k] > 0.0:
            value = paired_width(x[k], (one.rise[k], one.r[k]), (other.rise[k], other.r[k]), sector, pattern, law)
            value = value if law == LIGHT else value / one.r[k]
        for m in range(1, steps):
            out[i + m] = last + (value - last) * (m / steps)
        out[k] = value
        i, level, level_other, tip, tip_other, r = k, levels, levels_other, tips, tips_other, one.r[k]
        if moved < DOUBLED and x[k] > 0.0 and steps < MOST_STEPS:
            steps *= 2
        if steps > x.size - 1 - k:
            steps = max(x.size - 1 - k, 1)


@kernel_uncounted
def sample_pattern(x, z, r, sector, pattern, fine, out):
    """Integral of a pattern over the sines of a sector's directions, at many knots.

    Parameters
    ----------
    x, z, r : ndarray of float64
        Ground range, height above the sonar and slant range of the knots, m; as many as x has.
    sector : AzimuthSector
        Of a width.
    pattern : BeamPattern
    fine : tuple of two float
        As of `weigh_knots`.
    out : ndarray
        Takes the integrals. They are read at knots between which the sector's borders and the slant range move by
        little; between them they follow the level part of the direction.
    """
    centre, extent, integral = pattern.centre, pattern.extent, pattern.integral
    first_range, per_octave, last_row = pattern.first_range, pattern.per_octave, extent.size - 1.0
    farther = max(abs(sector.s_low), abs(sector.s_high))
    level = tip = off = place = value = rate = 0.0
    i, steps, borders = -1, 1, 0
    while i < x.size - 1:
        k, last_level, last_tip, last_off, last_place, last_borders = i + steps, level, tip, off, place, borders
        per_range = 1.0 / r[k]
        level, tip = sector.ahead_level * x[k] * per_range, sector.ahead_up * z[k] * per_range
        s_low, s_high = level * sector.s_low + tip, level * sector.s_high + tip
        place = place_in_rows(last_row, first_range, per_octave, r[k]) if last_row > 0.0 else 0.0
        row = row_below(place, last_row)
        off = max(s_low - centre, centre - s_high, 0.0)
        half = extent[np.uint64(row)]
        borders = 3 * _side_of_beam(s_low - centre, half) + _side_of_beam(s_high - centre, half)
        per_sine = _samples_per_sine(min(off, last_off), sector.s_beam, fine, half)
        moved = (abs(level - last_level) * farther + abs(tip - last_tip)) * per_sine
        moved = max(moved, abs(place - last_place) * (1.0 / FINE_ROW))
        # NaN, a hole in the bed, compares false. Where a border crosses the edge of a top-hat, the weight has a kink.
        if steps > 1 and not (moved <= 1.0 and borders == last_borders):
            steps, level, tip, off = steps >> 1, last_level, last_tip, last_off
            place, borders = last_place, last_borders
            continue
        last_value, last_rate = value, rate
        value, at_low, at_high = response_between(centre, extent, integral, row, place - row, s_low, s_high)
        # Level and upward part of a direction lie on a circle, so that one is a function of the other.
        rate = at_high * sector.s_high - at_low * sector.s_low
        if sector.ahead_up != 0.0:
            rate -= (at_high - at_low) * sector.ahead_up / sector.ahead_level * x[k] / _away_from_zero(z[k], x[k])
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
def _side_of_beam(s, half):
    """Side of the beam on which a direction lies: -1 or 1 beyond its edges, 0 within."""
    return int(s > half) - int(s < -half)


@inlined_uncounted
def _samples_per_sine(off, main, fine, extent):
    """Return the samples of a pattern per change of s, where the nearer border of a sector is so far off the axis.

    A sector beside the whole beam may come as near as its edge, lest it cross the beam between two samples.
    """
    if off > extent:
        return 1.0 / (off - extent)
    return 1.0 / ((fine[0] if off < main else fine[1]) * main)


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
