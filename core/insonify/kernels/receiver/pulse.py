"""Pulse and delay of the mean echo: the pulse spreads it over range, fluctuations of the water shift it.

Beyond the last bin the echo is continued at its last value, so that a uniform bed stays uniform to the end.

Theory: docs/theory/speckle.md.
"""

import math

from insonify.compiler.jit import kernel


@kernel
def convolve_pulse(record, taps, before, out):
    """Convolve every side of every ping with the energy of the pulse.

    Parameters
    ----------
    record : ndarray of float32, shape (n, 2, bins)
    taps : ndarray of float32
        Weights of the pulse.
    before : int
        How many of the taps lie before the echo's own bin.
    out : ndarray of float32, shape (n, 2, bins)
        Added to.
    """
    pings, sides, bins = record.shape
    for ping in range(pings):
        for side in range(sides):
            for tap in range(taps.size):
                late = tap - before
                # The slices are indexed from 0: an index that might be negative prevents vectorisation.
                echo, received = record[ping, side, max(-late, 0) :], out[ping, side, max(late, 0) :]
                for k in range(min(echo.size, received.size)):
                    received[k] += echo[k] * taps[tap]
                for k in range(max(bins + late, 0), bins):
                    out[ping, side, k] += record[ping, side, bins - 1] * taps[tap]


@kernel
def delay_pings(record, bins_late, out):
    """Delay every ping by its own number of bins; a fractional delay shares energy between two bins.

    Parameters
    ----------
    record : ndarray of float32, shape (n, 2, bins)
    bins_late : ndarray of float64, shape (n,)
        Whole or not, of any sign.
    out : ndarray of float32, shape (n, 2, bins)
        Takes the result.
    """
    pings, sides, bins = record.shape
    for ping in range(pings):
        whole = math.floor(bins_late[ping])
        part = bins_late[ping] - whole
        for side in range(sides):
            for k in range(bins):
                near, far = min(k - whole - 1, bins - 1), min(k - whole, bins - 1)
                value = (1.0 - part) * record[ping, side, far] if far >= 0 else 0.0
                if near >= 0:
                    value += part * record[ping, side, near]
                out[ping, side, k] = value
