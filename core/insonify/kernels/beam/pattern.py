"""The beam's pattern, read from its table, and the azimuths at which to listen to it."""

from __future__ import annotations

import math

from insonify.kernels.common.jit import inlined_uncounted, kernel
from insonify.kernels.common.types import EVERY_GRAZING, LIGHT, TOP_HAT

SLICES = 16  # of the azimuths over which a pattern is averaged


@inlined_uncounted
def _table_response(pattern, s, r):
    """Sensitivity in the directions of s at slant range r: bilinear in s and log r."""
    row, share = _row(pattern, r)
    response = _energy(pattern, row, s)
    return response + share * (_energy(pattern, row + 1, s) - response) if share > 0.0 else response


@inlined_uncounted
def integrated_response(centre, extent, integral, first_range, per_octave, s_low, s_high, r):
    """Integral of the sensitivity over s between two values, at slant range r.

    It takes the pattern's parts, for taking one out costs more than a look into the table.
    """
    row, share = _place(extent, first_range, per_octave, r)
    response = _step(centre, extent[row], integral, row, s_low, s_high)
    if share > 0.0:
        response += share * (_step(centre, extent[row + 1], integral, row + 1, s_low, s_high) - response)
    return response


@inlined_uncounted
def _step(centre, extent, integral, row, s_low, s_high):
    """Difference of one row's integral between two values of s."""
    last = integral.shape[1] - 1
    scale = last / (2.0 * extent)
    low = min(max((s_low - centre + extent) * scale, 0.0), float(last))
    high = min(max((s_high - centre + extent) * scale, 0.0), float(last))
    if low >= high:
        return 0.0
    i, j = min(int(low), last - 1), min(int(high), last - 1)
    below = integral[row, i] + (low - i) * (integral[row, i + 1] - integral[row, i])
    return integral[row, j] + (high - j) * (integral[row, j + 1] - integral[row, j]) - below


@inlined_uncounted
def _row(pattern, r):
    """Row of the table that a slant range falls in, and how far it is on its way to the next."""
    return _place(pattern.extent, pattern.first_range, pattern.per_octave, r)


@inlined_uncounted
def _column(pattern, row, s):
    """Column of one row that s falls at, whole or not; beyond its ends outside the table."""
    extent = pattern.extent[row]
    return (s - pattern.centre + extent) / (2.0 * extent) * (pattern.energy.shape[1] - 1)


@inlined_uncounted
def _place(extent, first_range, per_octave, r):
    """Row for a slant range and the way on to the next, from the pattern's parts."""
    last = extent.size - 1
    if last == 0 or r <= first_range:
        return 0, 0.0
    place = min(math.log2(r / first_range) * per_octave, float(last))
    row = min(int(place), last - 1)
    return row, place - row


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
    """Sensitivity of one row at s, nothing beyond its extent."""
    columns, place = pattern.energy.shape[1], _column(pattern, row, s)
    if not 0.0 <= place <= columns - 1:
        return 0.0
    k = min(int(place), columns - 2)
    return pattern.energy[row, k] + (place - k) * (pattern.energy[row, k + 1] - pattern.energy[row, k])


@inlined_uncounted
def widest_extent(pattern):
    """Greatest extent of any row."""
    extent = 0.0
    for row in range(pattern.extent.size):
        extent = max(extent, pattern.extent[row])
    return extent


@inlined_uncounted
def pick_azimuth(pattern, level, tip, r, place):
    """Pick the azimuth of a ray for a place in [0, 1), and the angle it stands for: (azimuth, angle).

    Over azimuths φ, s = level · sin φ + tip. Half the rays are spread evenly over all that is heard, for the sidelobes;
    half as the pattern has it at slant range r, for the main lobe. Each stands for one over the density of both.
    """
    extent = widest_extent(pattern)
    low = min(max((pattern.centre - extent - tip) / level, -1.0), 1.0)
    high = min(max((pattern.centre + extent - tip) / level, -1.0), 1.0)
    if low >= high:
        return 0.0, 0.0
    first, last = math.asin(low), math.asin(high)
    row, _ = _row(pattern, r)
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
    """Find s at which the integral of one row reaches a value."""
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
    """Mean sensitivity of one row over the column that s falls in: the slope of its integral."""
    columns, place = pattern.integral.shape[1], _column(pattern, row, s)
    if not 0.0 <= place <= columns - 1:
        return 0.0
    k = min(int(place), columns - 2)
    return (pattern.integral[row, k + 1] - pattern.integral[row, k]) * (columns - 1) / (2.0 * pattern.extent[row])


@inlined_uncounted
def azimuthal_response(pattern, level, tip, r):
    """Integral of the sensitivity over all azimuths of one side at slant range r, where s = level · sin φ + tip."""
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


@inlined_uncounted
def vertical_response(pattern, side, up):
    """Sensitivity of the vertical beam in a direction with these parts along the fish's own side and up."""
    c, s = math.cos(pattern.tilt), math.sin(pattern.tilt)
    # Parts of the direction along the tilted axis, and at right angles to it.
    along, off = side * c - up * s, (up * c + side * s) / pattern.s_vertical
    if along <= 0.0:
        return 0.0
    if pattern.vertical == TOP_HAT:
        return 1.0 if abs(off) <= 1.0 else 0.0
    return 2.0 ** (-off * off * (2.0 if pattern.two_way else 1.0))


@inlined_uncounted
def two_way_response(pattern, beam, fan, law, dx, dy, dz, r):
    """Sensitivity of a pattern in a direction of the world; law `light` averages over its azimuths."""
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
    """Azimuth that a level fish's beam takes in, by its sensitivity, of rings at ground ranges x and slant ranges r."""
    for k in range(x.size):
        out[k] = azimuthal_response(pattern, x[k] / r[k], 0.0, r[k]) if x[k] > 0.0 else 0.0


@kernel
def vertical_responses(pattern, elevation, out):
    """Sensitivity of the vertical beam of a level fish at elevations above the horizontal, in radians."""
    for k in range(elevation.size):
        out[k] = vertical_response(pattern, math.cos(elevation[k]), math.sin(elevation[k]))
