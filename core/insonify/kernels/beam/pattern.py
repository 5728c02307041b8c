"""Beam patterns read from their tables: the response in one direction or over many, and azimuths to sample it at.

Tables are by row of slant range and by the sine s of the angle from athwart.

Theory: docs/theory/beam.md.
"""

import math

import numpy as np

from insonify.compiler.jit import inlined_uncounted, kernel, kernel_uncounted
from insonify.kernels.common.types import EVERY_GRAZING, LIGHT, TABLE, TOP_HAT

SLICES = 16  # of the azimuths over which a pattern is averaged
SHARED_SLICES = 128  # of the azimuths that two directions share, sidelobes and all
LN2, LEAST_EXPONENT = math.log(2.0), -1000.0
HALF_OCTAVE = np.float64(math.sqrt(0.5)).view(np.int64)  # bits of 1/√2, which part exponent from mantissa
PER_LN2 = 2.0 / math.log(2.0)


@inlined_uncounted
def integrated_response(centre, extent, integral, first_range, per_octave, s_low, s_high, r):
    """Integral of the two-way response over s between two values, at one slant range."""
    # The arguments are the pattern's arrays: unpacking its tuple costs more than reading the table.
    row, share = row_of_range(extent, first_range, per_octave, r)
    low = _integral_up_to(centre, extent, integral, row, s_low)
    value = _integral_up_to(centre, extent, integral, row, s_high) - low
    if extent.size > 1:
        low = _integral_up_to(centre, extent, integral, row + 1, s_low)
        value += share * (_integral_up_to(centre, extent, integral, row + 1, s_high) - low - value)
    return value


@inlined_uncounted
def _integral_up_to(centre, extent, integral, row, s):
    """Integral of one row up to a value of s, beyond the table and for NaN up to its end."""
    half, last = extent[np.uint64(row)], integral.shape[1] - 1.0
    wanted = (s - centre + half) * (last / (2.0 * half))
    place = wanted if wanted > 0.0 else 0.0
    place = place if place < last else last
    k = int(place if place < last - 1.0 else last - 1.0)
    # Indices that cannot be negative: loops over knots become vector code.
    before, after = integral[np.uint64(row), np.uint64(k)], integral[np.uint64(row), np.uint64(k + 1)]
    return before + (place - k) * (after - before)


@inlined_uncounted
def row_of_range(extent, first_range, per_octave, r):
    """Row of a table for a slant range, and the fraction of the way to the next row."""
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


@inlined_uncounted
def _table_response(pattern, s, r):
    """Two-way response in the directions of s at a slant range, bilinear in s and log r."""
    row, share = row_of_range(pattern.extent, pattern.first_range, pattern.per_octave, r)
    response = _energy(pattern, row, s)
    return response + share * (_energy(pattern, row + 1, s) - response) if share > 0.0 else response


@inlined_uncounted
def _column(pattern, row, s):
    """Fractional column of one row for a value of s; outside the table beyond the row's extent."""
    extent = pattern.extent[row]
    return (s - pattern.centre + extent) / (2.0 * extent) * (pattern.energy.shape[1] - 1)


@inlined_uncounted
def _integral(pattern, row, s):
    """Integral of one row up to s."""
    columns, place = pattern.integral.shape[1], _column(pattern, row, s)
    if place <= 0.0:
        return 0.0
    if place >= columns - 1:
        return pattern.integral[row, columns - 1]
    k = int(place)
    return pattern.integral[row, k] + (place - k) * (pattern.integral[row, k + 1] - pattern.integral[row, k])


@inlined_uncounted
def _energy(pattern, row, s):
    """Two-way response of one row at s, 0 beyond its extent."""
    columns, place = pattern.energy.shape[1], _column(pattern, row, s)
    if not 0.0 <= place <= columns - 1:
        return 0.0
    k = min(int(place), columns - 2)
    return pattern.energy[row, k] + (place - k) * (pattern.energy[row, k + 1] - pattern.energy[row, k])


@inlined_uncounted
def is_top_hat(pattern):
    """Whether a tabulated pattern is alike over all that it spans, at every slant range."""
    return pattern.integral.shape[0] == 1 and pattern.integral.shape[1] == 2


@inlined_uncounted
def top_hat_level(pattern):
    """Two-way response of a top-hat pattern inside the beam."""
    return 0.5 * pattern.integral[0, 1] / pattern.extent[0]


@inlined_uncounted
def widest_extent(pattern):
    """Greatest extent of any row of a pattern."""
    extent = 0.0
    for row in range(pattern.extent.size):
        extent = max(extent, pattern.extent[row])
    return extent


@inlined_uncounted
def pick_azimuth(pattern, level, tip, r, place):
    """Azimuth of a ray within a beam, and the angle it stands for."""
    # Over azimuths φ, s = level · sin φ + tip. Half the rays are spread evenly over all that the beam takes in, for the
    # sidelobes; half follow the pattern, for the main lobe. Each stands for one over the joint density.
    extent = widest_extent(pattern)
    low = min(max((pattern.centre - extent - tip) / level, -1.0), 1.0)
    high = min(max((pattern.centre + extent - tip) / level, -1.0), 1.0)
    if low >= high:
        return 0.0, 0.0
    first, last = math.asin(low), math.asin(high)
    row, _ = row_of_range(pattern.extent, pattern.first_range, pattern.per_octave, r)
    before = _integral(pattern, row, level * low + tip)
    whole = _integral(pattern, row, level * high + tip) - before
    if whole <= 0.0:
        return first + place * (last - first), last - first
    if place < 0.5:
        azimuth = first + 2.0 * place * (last - first)
    else:
        s = _where_integral(pattern, row, before + (2.0 * place - 1.0) * whole)
        azimuth = math.asin(min(max((s - tip) / level, low), high))
    sine = math.sin(azimuth)
    lobe = _mean_energy(pattern, row, level * sine + tip) * level * math.cos(azimuth) / whole
    return azimuth, 1.0 / (0.5 / (last - first) + 0.5 * lobe)


@inlined_uncounted
def _where_integral(pattern, row, value):
    """Value of s at which the integral of one row reaches a value."""
    low, high = 0, pattern.integral.shape[1] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if pattern.integral[row, middle] <= value:
            low = middle
        else:
            high = middle
    step = pattern.integral[row, high] - pattern.integral[row, low]
    share = (value - pattern.integral[row, low]) / step if step > 0.0 else 0.5
    extent = pattern.extent[row]
    return pattern.centre - extent + 2.0 * extent * (low + share) / (pattern.integral.shape[1] - 1)


@inlined_uncounted
def _mean_energy(pattern, row, s):
    """Mean response of one row over the column that s falls in: the slope of its integral."""
    columns, place = pattern.integral.shape[1], _column(pattern, row, s)
    if not 0.0 <= place <= columns - 1:
        return 0.0
    k = min(int(place), columns - 2)
    return (pattern.integral[row, k + 1] - pattern.integral[row, k]) * (columns - 1) / (2.0 * pattern.extent[row])


@inlined_uncounted
def azimuthal_response(pattern, level, tip, r):
    """Integral of the two-way response over all azimuths of one side, where s = level · sin φ + tip."""
    extent = widest_extent(pattern)
    low = math.asin(min(max((pattern.centre - extent - tip) / level, -1.0), 1.0))
    high = math.asin(min(max((pattern.centre + extent - tip) / level, -1.0), 1.0))
    step, total, before = (high - low) / SLICES, 0.0, math.sin(low)
    centre, first_range, per_octave = pattern.centre, pattern.first_range, pattern.per_octave
    extents, integral = pattern.extent, pattern.integral
    for k in range(SLICES):
        after = math.sin(low + (k + 1) * step)
        if after > before:
            s_low, s_high = level * before + tip, level * after + tip
            response = integrated_response(centre, extents, integral, first_range, per_octave, s_low, s_high, r)
            total += response / (s_high - s_low) * step
        before = after
    return total


@kernel_uncounted
def shared_response(pattern, level_one, tip_one, r_one, level_other, tip_other, r_other):
    """Integral over azimuths of the response to sound that leaves in one direction and returns from another."""
    extent, centre = widest_extent(pattern), pattern.centre
    low = max((centre - extent - tip_one) / level_one, (centre - extent - tip_other) / level_other, -1.0)
    high = min((centre + extent - tip_one) / level_one, (centre + extent - tip_other) / level_other, 1.0)
    if not low < high:
        return 0.0
    low, high = math.asin(low), math.asin(high)
    if is_top_hat(pattern):
        return top_hat_level(pattern) * (high - low)
    step, total = (high - low) / SHARED_SLICES, 0.0
    for k in range(SHARED_SLICES):
        sine = math.sin(low + (k + 0.5) * step)
        one = _table_response(pattern, level_one * sine + tip_one, r_one)
        total += math.sqrt(one * _table_response(pattern, level_other * sine + tip_other, r_other))
    return total * step


@inlined_uncounted
def vertical_response(pattern, side, up):
    """Two-way response of the vertical beam in a direction."""
    if pattern.vertical == TABLE:
        return _table_response_above(pattern, side, up)
    return lobe_response(pattern, side, up)


@inlined_uncounted
def lobe_response(pattern, side, up):
    """Two-way response of a vertical beam of a single lobe; arguments and result as of `vertical_response`."""
    # Loops over knots take it alone: with a table beside it they are a tenth slower.
    c, s = math.cos(pattern.tilt), math.sin(pattern.tilt)
    # Parts of the direction along the tilted axis, and at right angles to it.
    along, off = side * c - up * s, (up * c + side * s) / pattern.s_vertical
    if along <= 0.0:
        return 0.0
    if pattern.vertical == TOP_HAT:
        return 1.0 if abs(off) <= 1.0 else 0.0
    return _power_of_two(-off * off * (2.0 if pattern.two_way else 1.0))


@inlined_uncounted
def _power_of_two(exponent):
    """Two to a power not above 0, to 1e-10, in a form that vectorises."""
    limited = exponent if exponent > LEAST_EXPONENT else LEAST_EXPONENT
    whole = math.floor(limited + 0.5)
    t = (limited - whole) * LN2
    # e to the power t by its series, |t| <= ln 2 / 2; then the whole part goes into the exponent's bits.
    tail = 1.0 / 120.0 + t * (1.0 / 720.0 + t * (1.0 / 5040.0 + t * (1.0 / 40320.0)))
    series = 1.0 + t * (1.0 + t * (0.5 + t * (1.0 / 6.0 + t * (1.0 / 24.0 + t * tail))))
    return series * np.int64((np.int64(whole) + 1023) << np.int64(52)).view(np.float64)


@inlined_uncounted
def _table_response_above(pattern, side, up):
    """Two-way response of a vertical beam by a table, 0 behind the transducer."""
    c, s = math.cos(pattern.tilt), math.sin(pattern.tilt)
    if side * c - up * s <= 0.0:
        return 0.0
    energy = pattern.vertical_energy  # at equal steps of the sine, from -1 to 1
    last = energy.size - 1
    place = min(max(0.5 * (up * c + side * s + 1.0), 0.0), 1.0) * last
    k = min(int(place), last - 1)
    return energy[k] + (place - k) * (energy[k + 1] - energy[k])


@inlined_uncounted
def two_way_response(pattern, beam, fan, law, dx, dy, dz, r):
    """Two-way response of a beam in a direction of the world."""
    value = 1.0
    if pattern.vertical != EVERY_GRAZING:
        side = dx * beam.own_x + dy * beam.own_y + dz * beam.own_z
        value = vertical_response(pattern, side, dx * beam.up_x + dy * beam.up_y + dz * beam.up_z)
    if not fan or value == 0.0:
        return value
    value *= _table_response(pattern, dx * beam.axis_x + dy * beam.axis_y + dz * beam.axis_z, r)
    if law != LIGHT or value == 0.0:
        return value
    cos_pitch, cos_elevation = math.sqrt(1.0 - beam.axis_z * beam.axis_z), math.sqrt(dx * dx + dy * dy)
    return value / azimuthal_response(pattern, cos_pitch * cos_elevation, beam.axis_z * dz, r)


@kernel
def ring_responses(pattern, x, r, out):
    """Azimuth of rings on the bed inside the beam of a level fish, weighted by its two-way response.

    Parameters
    ----------
    pattern : BeamPattern
    x, r : ndarray of float64, shape (n,)
        Ground ranges and slant ranges of the rings, m.
    out : ndarray of float64, shape (n,)
        Takes the azimuths, rad.
    """
    for k in range(x.size):
        out[k] = azimuthal_response(pattern, x[k] / r[k], 0.0, r[k]) if x[k] > 0.0 else 0.0


@kernel
def vertical_responses(pattern, elevation, out):
    """Two-way response of the vertical beam of a level fish at elevations above the horizontal, rad, into an array."""
    for k in range(elevation.size):
        out[k] = vertical_response(pattern, math.cos(elevation[k]), math.sin(elevation[k]))
