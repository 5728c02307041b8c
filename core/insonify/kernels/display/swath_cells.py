"""Samples of a record added up in the cells of a map."""

import math

import numpy as np

from insonify.compiler.jit import inlined, kernel


@kernel
def add_samples(swath, pings, corner, cell, longest, energy, ground_range, count):
    """Add the samples of a record, half a cell apart at most, to the cells that hold them.

    Parameters
    ----------
    swath : Swath
        The pings of a record as lines on the map.
    pings : int
        How many of them are added; the next one, if there is one, ends the interval behind the last.
    corner : ndarray of float64, shape (2,)
        Lower left corner of the cells on the map, m.
    cell : float
        Their side, m.
    longest : float
        Distance between successive pings up to which what lies between them is interpolated, m.
    energy, ground_range : ndarray of float64, shape (rows, columns)
        Sums over the samples of a cell, added to; the southernmost row first. ``ground_range`` may be empty.
    count : ndarray of int32, shape (rows, columns)
        Samples of a cell, added to.
    """
    step = min(0.5 * cell, swath.bin_length)
    samples = max(math.ceil(swath.reach / step - 0.5), 0)
    here, there = np.empty((2, samples)), np.empty((2, samples))
    last = swath.altitude.size - 1
    _read_energy(swath, 0, step, there)
    for ping in range(pings):
        following = min(ping + 1, last)
        here[:] = there
        _read_energy(swath, following, step, there)
        moved = _distance(swath.nadir[ping], swath.nadir[following])
        turned = max(
            _distance(swath.ends[ping, 0], swath.ends[following, 0]),
            _distance(swath.ends[ping, 1], swath.ends[following, 1]),
        )
        parts = max(math.ceil(max(moved, turned) / (0.5 * cell)), 1) if moved <= longest else 1
        for part in range(parts):
            share = part / parts
            # Column and row at no ground range, then at the far end.
            x, y = _place(swath.nadir[ping], swath.nadir[following], share, corner, cell)
            for side in range(2):
                far_x, far_y = _place(swath.ends[ping, side], swath.ends[following, side], share, corner, cell)
                for k in range(samples):
                    distance = (k + 0.5) * step
                    along = distance / swath.reach
                    column, row = x + along * (far_x - x), y + along * (far_y - y)
                    sample = here[side, k]
                    if share > 0.0:
                        sample = (1.0 - share) * sample + share * there[side, k]
                    # Comparisons with NaN are false.
                    if math.isfinite(sample) and 0.0 <= column < count.shape[1] and 0.0 <= row < count.shape[0]:
                        at = int(row), int(column)
                        energy[at] += sample
                        if ground_range.size > 0:
                            ground_range[at] += distance
                        count[at] += 1


@inlined
def _read_energy(swath, ping, step, out):
    """Energy of a ping at ground ranges on both sides, (2, n); NaN beyond its last bin."""
    bins = swath.amplitude.shape[2]
    for k in range(out.shape[1]):
        # A level bed at the altitude of the ping turns slant range into ground range: r² = g² + h².
        position = math.hypot((k + 0.5) * step, swath.altitude[ping]) / swath.bin_length
        for side in range(2):
            out[side, k] = math.nan
            if position < bins:
                amplitude = float(swath.amplitude[ping, side, int(position)])
                out[side, k] = amplitude * amplitude


@inlined
def _place(one, other, share, corner, cell):
    """Column and row of a place between two on the map."""
    return (
        ((1.0 - share) * one[0] + share * other[0] - corner[0]) / cell,
        ((1.0 - share) * one[1] + share * other[1] - corner[1]) / cell,
    )


@inlined
def _distance(one, other):
    """Distance between two places on the map."""
    return math.hypot(other[0] - one[0], other[1] - one[1])
