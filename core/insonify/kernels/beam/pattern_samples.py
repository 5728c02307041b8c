"""Integrals of a beam pattern over the sines of a sector's directions, at many knots of a profile.

The knots at which the table is read are chosen first. Each later pass does one thing for all of them, so that the
compiler can use its vector units.

Theory: docs/theory/beam.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.beam.pattern import place_in_rows, row_below
from insonify.kernels.bed.profile import padded_count

BLOCK = 8  # knots from one at which a pattern is read to the next, at most: the lanes of a vector unit
WHOLE = 0.8  # share of what follows up to which a block is read at its ends only; to twice that in its middle too
# Up to the next one the sector's borders move by less than this share of half the main lobe, on it and on sidelobes,
# and the slant range by less than this share of a row of the table.
FINE_SINE, FINE_ROW = (1.0 / 8.0, 1.0 / 2.0), 1.0 / 2.0
# The same where the root of two responses counts, which is large where one of them is small.
FINE_ROOT = (1.0 / 24.0, 1.0 / 24.0)
# Samples for which the table is read at a time, and where what is found of each of them lies in the work space: of the
# nearer and the farther row the extent and the first entry, and of the borders in both rows what `_find_columns` gives.
AT_ONCE = 64
(
    NEAR, FAR, SHARE, LOW, HIGH, FAR_LOW, FAR_HIGH,
) = (np.uint64(AT_ONCE * place) for place in (0, 2, 4, 5, 9, 13, 17))  # fmt: skip
ENTRY, BEYOND, PER_SINE, RISE = (np.uint64(AT_ONCE * place) for place in (1, 1, 2, 3))
ROOM = 21 * AT_ONCE
LEAST_HEIGHT = 0.01  # share of a ground range


class SampleRoom(NamedTuple):
    """Work space for the samples of a pattern, one entry a sample."""

    listed: NDArray[np.int32]  # of a block's end the steps within the block, then the knots within blocks
    first: NDArray[np.float64]  # ground range of the sample, then the level part of s
    second: NDArray[np.float64]  # height, then the upward part of s, then the rate of the integral over the level part
    third: NDArray[np.float64]  # slant range, then the row of the table, then the integral
    table: NDArray[np.float64]  # (ROOM,) what is read for AT_ONCE samples


@kernel_uncounted
def sample_pattern(x, z, r, sector, pattern, fine, room, out):
    """Integral of a pattern over the sines of a sector's directions, at many knots."""
    if x.size == 0:
        return
    listed, first, second, third, table = room
    blocks = (x.size - 1 + BLOCK - 1) // BLOCK
    for j in range(blocks + 1):
        _take_knot(j, min(j * BLOCK, x.size - 1), x, z, r, first, second, third)
    _find_directions(0, blocks + 1, sector, pattern, first, second, third)
    samples = _list_knots(blocks, x.size, sector, pattern, fine, first, second, third, listed)
    for j in range(blocks + 1, samples):
        _take_knot(j, listed[np.uint64(j)], x, z, r, first, second, third)
    _find_directions(blocks + 1, samples, sector, pattern, first, second, third)
    _read_integrals(samples, sector, pattern, first, second, third, table)
    _fill_blocks(blocks, x, r, sector.ahead_level, first, second, third, listed, out)


@inlined_uncounted
def _take_knot(j, k, x, z, r, first, second, third):
    """Copy one knot to the samples."""
    to, taken = np.uint64(j), np.uint64(k)
    first[to], second[to], third[to] = x[taken], z[taken], r[taken]


@inlined_uncounted
def _find_directions(begin, end, sector, pattern, first, second, third):
    """Turn places of samples, x, z and r, into the level and the upward part of s and the row of the table."""
    ahead_level, ahead_up = sector.ahead_level, sector.ahead_up
    last_row, first_range, per_octave = pattern.extent.size - 1.0, pattern.first_range, pattern.per_octave
    for j in range(np.uint64(begin), np.uint64(end)):
        r = third[j]
        per_range = 1.0 / r
        first[j] = ahead_level * first[j] * per_range
        second[j] = ahead_up * second[j] * per_range
        third[j] = place_in_rows(last_row, first_range, per_octave, r)


@inlined_uncounted
def _list_knots(blocks, knots, sector, pattern, fine, level, tip, place, listed):
    """List the knots within blocks at which the pattern is read too, after the blocks' ends; return their number."""
    # The first entries of the list hold the steps between those of each block, by the block's end.
    centre, extent, s_low, s_high, s_beam = pattern.centre, pattern.extent, sector.s_low, sector.s_high, sector.s_beam
    farther, last_row, samples = max(abs(s_low), abs(s_high)), extent.size - 1.0, blocks + 1
    last_off, last_borders = 0.0, 0
    for j in range(blocks + 1):
        at = np.uint64(j)
        low, high = level[at] * s_low + tip[at] - centre, level[at] * s_high + tip[at] - centre
        off, half = max(low, -high, 0.0), extent[np.uint64(row_below(place[at], last_row))]
        borders = 3 * _side_of_beam(low, half) + _side_of_beam(high, half)
        if j > 0:
            before = np.uint64(j - 1)
            per_sine = _samples_per_sine(min(off, last_off), s_beam, fine, half)
            moved = (abs(level[at] - level[before]) * farther + abs(tip[at] - tip[before])) * per_sine
            moved = max(moved, abs(place[at] - place[before]) * (1.0 / FINE_ROW))
            # NaN, a hole in the bed, compares false. Where a border crosses the edge of a top-hat, there is a kink.
            step = _step_for(moved) if borders == last_borders else 1
            listed[at] = step
            for k in range((j - 1) * BLOCK + step, min(j * BLOCK, knots - 1), step):
                listed[np.uint64(samples)] = k
                samples += 1
        last_off, last_borders = off, borders
    return samples


@inlined_uncounted
def _step_for(moved):
    """Knots from one at which the pattern is read to the next in a block, by how far it moves from end to end."""
    if moved <= WHOLE:
        return BLOCK
    if moved <= 2.0 * WHOLE:
        return BLOCK // 2
    return BLOCK // 4 if moved <= 4.0 * WHOLE else 1


@inlined_uncounted
def _read_integrals(samples, sector, pattern, level, tip, place, room):
    """Read the table: the integral takes the place of the row, its rate over the level part that of the upward one."""
    extent, columns = pattern.extent, pattern.integral.shape[1]
    entries, centre = pattern.integral.reshape(pattern.integral.size), pattern.centre
    for begin in range(0, samples, AT_ONCE):
        count, many = min(samples - begin, AT_ONCE), padded_count(min(samples - begin, AT_ONCE))
        _find_rows(begin, count, extent, columns, place, room)
        _find_columns(begin, many, level, tip, sector.s_low, centre, columns, NEAR, LOW, room)
        _find_columns(begin, many, level, tip, sector.s_high, centre, columns, NEAR, HIGH, room)
        _read_table(count, entries, LOW, room)
        _read_table(count, entries, HIGH, room)
        if extent.size > 1:
            _find_columns(begin, many, level, tip, sector.s_low, centre, columns, FAR, FAR_LOW, room)
            _find_columns(begin, many, level, tip, sector.s_high, centre, columns, FAR, FAR_HIGH, room)
            _read_table(count, entries, FAR_LOW, room)
            _read_table(count, entries, FAR_HIGH, room)
            _pass_to_farther_row(many, LOW, FAR_LOW, room)
            _pass_to_farther_row(many, HIGH, FAR_HIGH, room)
        _combine_borders(begin, many, sector, level, tip, place, room)


@inlined_uncounted
def _find_rows(begin, count, extent, columns, place, room):
    """Find the rows about samples: their extents and first entries, and the fraction of the way to the farther one."""
    last_row, rows = extent.size - 1.0, np.uint64(extent.size)
    for i in range(np.uint64(count)):
        at = place[np.uint64(begin) + i]
        row = np.uint64(row_below(at, last_row))
        farther = row + np.uint64(1) if row + np.uint64(1) < rows else row
        room[NEAR + i], room[FAR + i] = extent[row], extent[farther]
        room[NEAR + ENTRY + i], room[FAR + ENTRY + i] = row * np.uint64(columns), farther * np.uint64(columns)
        room[SHARE + i] = at - row


@inlined_uncounted
def _find_columns(begin, count, level, tip, border, centre, columns, row, corner, room):
    """Find the entries of a row about a border: place, what is beyond, columns per sine or 0."""
    last = columns - 1.0
    for i in range(np.uint64(count)):
        j = np.uint64(begin) + i
        half = room[row + i]
        scale = last / (half + half)
        wanted = (level[j] * border + tip[j] - centre + half) * scale
        found = wanted if wanted > 0.0 else 0.0
        found = found if found < last else last
        column = math.floor(found if found < last - 1.0 else last - 1.0)
        room[corner + i] = room[row + ENTRY + i] + column
        room[corner + BEYOND + i] = found - column
        room[corner + PER_SINE + i] = scale if found == wanted else 0.0


@inlined_uncounted
def _read_table(count, entries, corner, room):
    """Read the integral up to a column, and what the column adds."""
    for i in range(np.uint64(count)):
        k = np.uint64(np.int64(room[corner + i]))
        before = entries[k]
        room[corner + i] = before
        room[corner + RISE + i] = entries[k + np.uint64(1)] - before


@inlined_uncounted
def _pass_to_farther_row(count, near, far, room):
    """Pass from the integral and the response at a border of one row to those between two rows."""
    for i in range(np.uint64(count)):
        share, value, response = room[SHARE + i], _integral(near, i, room), _response(near, i, room)
        room[near + i] = value + share * (_integral(far, i, room) - value)
        room[near + RISE + i] = response + share * (_response(far, i, room) - response)
        room[near + BEYOND + i], room[near + PER_SINE + i] = 0.0, 1.0


@inlined_uncounted
def _integral(corner, i, room):
    """Integral of a row up to a border."""
    return room[corner + i] + room[corner + BEYOND + i] * room[corner + RISE + i]


@inlined_uncounted
def _response(corner, i, room):
    """Response of a row at a border, the mean over a column of the table."""
    return room[corner + RISE + i] * room[corner + PER_SINE + i]


@inlined_uncounted
def _combine_borders(begin, count, sector, level, tip, place, room):
    """Put the integral between both borders in the row's place, and its rate in that of the upward part."""
    s_low, s_high = sector.s_low, sector.s_high
    for i in range(np.uint64(count)):
        j, low, high = np.uint64(begin) + i, _response(LOW, i, room), _response(HIGH, i, room)
        place[j] = _integral(HIGH, i, room) - _integral(LOW, i, room)
        room[NEAR + i], room[FAR + i] = tip[j], high - low
        tip[j] = high * s_high - low * s_low
    if sector.ahead_up != 0.0:
        # Level and upward part of a direction lie on a circle, so that one is a function of the other.
        steepness = sector.ahead_up / sector.ahead_level
        for i in range(np.uint64(count)):
            j = np.uint64(begin) + i
            ground, height = level[j], room[NEAR + i] / steepness
            tip[j] -= room[FAR + i] * steepness * ground / _away_from_zero(height, ground)


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
    """Return the samples of a pattern per change of s, where the nearer border of a sector is so far off the axis."""
    # A sector beside the whole beam may come as near as its edge, lest it cross the beam between two samples.
    if off > extent:
        return 1.0 / (off - extent)
    return 1.0 / ((fine[0] if off < main else fine[1]) * main)


@inlined_uncounted
def _fill_blocks(blocks, x, r, ahead_level, level, rate, value, listed, out):
    """Fill the knots of every block from the samples at its ends and within it."""
    sample = np.uint64(blocks + 1)
    out[0] = value[0]
    for j in range(blocks):
        at, first = np.uint64(j), np.uint64(j * BLOCK + 1)
        after = at + np.uint64(1)
        beyond = np.uint64(min((j + 1) * BLOCK, x.size - 1))
        step = np.uint64(listed[after])
        before = at
        while first + step <= beyond:
            middle = first + step - np.uint64(1)
            _fill_chord(first, middle, x, r, ahead_level, (level, rate, value), before, sample, out)
            before, first = sample, middle + np.uint64(1)
            sample += np.uint64(1)
        _fill_chord(first, beyond, x, r, ahead_level, (level, rate, value), before, after, out)


@inlined_uncounted
def _fill_chord(first, beyond, x, r, ahead_level, samples, before, after, out):
    """Fill the knots up to one at which a function of a direction's level part is known, as it is before the first."""
    # To the second order it is the chord, a parabola, and its slope times what the level part is off its own chord.
    all_levels, all_rates, all_values = samples
    if first == beyond:
        out[beyond] = all_values[after]
        return
    steps = np.int64(beyond - first) + 1
    level, value, rate = all_levels[before], all_values[before], all_rates[before]
    levels, values, rates = all_levels[after] - level, all_values[after] - value, all_rates[after] - rate
    per_step, bend = 1.0 / steps, 0.5 * rates * levels
    # The last one too, which is known: a whole block fills a vector.
    for m in range(np.uint64(steps)):
        t, k = (np.int64(m) + 1.0) * per_step, first + m
        off_chord = ahead_level * x[k] / r[k] - level - t * levels
        filled = value + t * (values + (t - 1.0) * bend) + (rate + t * rates) * off_chord
        out[k] = filled if filled > 0.0 else 0.0
    out[beyond] = all_values[after]
