"""Weights of one plane's sector of the beam at the knots of a profile.

A pattern is read from its table at some knots only. Between two of them it is a function of the level part of the
direction; its value and slope are known at both. A top-hat has a closed form, which is evaluated at every knot.

Theory: docs/theory/beam.md.
"""

import math

from insonify.compiler.jit import NOTHING, inlined_uncounted, kernel_separate, kernel_uncounted
from insonify.kernels.beam.azimuth_sector import (
    in_plane_lobe,
    in_plane_response,
    paired_width,
    pattern_share,
    top_hat_share,
    top_hat_width,
)
from insonify.kernels.beam.pattern import is_top_hat, top_hat_level
from insonify.kernels.beam.pattern_samples import sample_pattern
from insonify.kernels.common.types import EVERY_GRAZING, LIGHT, TABLE

MOST_STEPS = 32  # knots from one at which two responses are read to the next
FINE_PAIR = 0.02  # share of a slant range, a direction's level part and half the main lobe, for two images
DOUBLED = 0.4  # of these limits, below which the next step is twice as long


@inlined_uncounted
def weigh_knots(x, z, r, sector, pattern, law, fine, room, out):
    """Factor by which a plane's sector multiplies the echo of each knot, as `sector_weight` for one place."""
    if sector.tabulated:
        _weigh_pattern(x, z, r, sector, pattern, law, fine, room, out)
    elif sector.angle == 0.0:
        for i in range(x.size):
            out[i] = 1.0  # a knife
    elif law == LIGHT:
        for i in range(x.size):
            out[i] = top_hat_share(x[i], r[i], sector)
    else:
        for i in range(x.size):
            out[i] = top_hat_width(x[i], r[i], sector)


@kernel_separate(NOTHING)
def _weigh_pattern(x, z, r, sector, pattern, law, fine, room, out):
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
            sample_pattern(x, z, r, sector, pattern, fine, room, out)
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
    ahead_level, ahead_up, level = sector.ahead_level, sector.ahead_up, top_hat_level(pattern)
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
    """Weight of each knot of a profile for a plane that represents a whole beam, and two images, as `paired_weight`."""
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


@inlined_uncounted
def _apply_ranges(x, r, sector, out):
    """Along-track width of a sector from the integral of the pattern over its sines, as `pattern_width`."""
    span = sector.ahead_level * (sector.s_high - sector.s_low)
    real, per_sine = out.dtype.type, sector.angle / span if span > 0.0 else 0.0
    for i in range(x.size):
        out[i] = out[i] * real(r[i] * per_sine) if x[i] > 0.0 else real(0.0)
