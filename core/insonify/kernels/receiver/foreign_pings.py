"""Pings of another sonar in the bins of a record, and one random number a ping.

Theory: docs/theory/speckle.md.
"""

import math
from typing import NamedTuple

import numpy as np

from insonify.compiler.jit import inlined, kernel
from insonify.kernels.common.hashing import hash_uniform


class Timing(NamedTuple):
    """When the bins of a record are received, and when another sonar pings, in seconds."""

    ping_interval: float
    bin_time: float  # that a bin lasts
    foreign_interval: float
    foreign_duration: float  # at most the interval


@kernel
def fill_foreign_pings(seed, stream, pings, timing, share, turns):
    """Share of every bin during which another sonar's ping arrives, and the phase of that ping.

    Parameters
    ----------
    seed, stream : int
        What the time of its first ping and the phases derive from.
    pings : ndarray of int64, shape (n,)
    timing : Timing
    share : ndarray of float32, shape (n, bins)
        Filled with 0 to 1.
    turns : ndarray of float32, shape (n, bins)
        Filled with phases in turns, one for each foreign ping.
    """
    begin = hash_uniform(seed, stream, 0, 0, 1) * timing.foreign_interval
    for row in range(pings.size):
        start = pings[row] * timing.ping_interval - begin
        for k in range(share.shape[1]):
            before, into = _foreign_ping_at(start + k * timing.bin_time, timing)
            number, reached = _foreign_ping_at(start + (k + 1) * timing.bin_time, timing)
            covered = (number - before) * timing.foreign_duration + reached - into
            share[row, k] = min(max(covered / timing.bin_time, 0.0), 1.0)
            turns[row, k] = hash_uniform(seed, stream, np.int64(number), 0, 0) if covered > 0.0 else 0.0


@inlined
def _foreign_ping_at(time, timing):
    """Count the other sonar's pings up to a time, and the seconds of the last that have arrived."""
    number = math.floor(time / timing.foreign_interval)
    return number, min(time - number * timing.foreign_interval, timing.foreign_duration)


@kernel
def fill_uniform(seed, stream, pings, out):
    """One uniform number inside (0, 1) for each ping, by seed and stream, into an array of float64."""
    for row in range(pings.size):
        out[row] = hash_uniform(seed, stream, pings[row], 0, 0)
