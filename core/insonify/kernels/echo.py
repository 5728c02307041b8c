"""What the receiver does to a traced record: a pulse lengthens every echo, speckle makes it flicker."""

from __future__ import annotations

import math

from insonify.kernels.hashing import hash_uniform
from insonify.kernels.jit import kernel


@kernel
def lengthen(record, taps, out):
    """Convolve every line with the pulse's taps; an echo begins at its range and lasts the pulse."""
    pings, sides, bins = record.shape
    for ping in range(pings):
        for side in range(sides):
            for tap in range(min(taps.size, bins)):
                for k in range(tap, bins):
                    out[ping, side, k] += record[ping, side, k - tap] * taps[tap]


@kernel
def flicker(record, pings, seed, stream):
    """Multiply every bin by an exponential number of mean 1, a function of ping, side and bin alone."""
    for row in range(pings.size):
        for side in range(record.shape[1]):
            for k in range(record.shape[2]):
                if record[row, side, k] > 0.0:
                    record[row, side, k] *= -math.log(hash_uniform(seed, stream, pings[row], side, k))
