"""What the receiver does to the mean echo: a pulse spreads it, the water shifts it.

Beyond the last bin the echo is taken to go on as it is there, so that an even bed is even to the end.
"""

from __future__ import annotations

import math

from insonify.kernels.common.jit import kernel


@kernel
def convolve_pulse(record, taps, before, out):
    """Convolve every line with the pulse's taps, of which so many lie before the echo's own bin."""
    pings, sides, bins = record.shape
    for ping in range(pings):
        for side in range(sides):
            for tap in range(taps.size):
                late = tap - before
                # Slices that are walked from 0: an index that might be negative would keep it off the vector units.
                echo, heard = record[ping, side, max(-late, 0) :], out[ping, side, max(late, 0) :]
                for k in range(min(echo.size, heard.size)):
                    heard[k] += echo[k] * taps[tap]
                for k in range(max(bins + late, 0), bins):
                    out[ping, side, k] += record[ping, side, bins - 1] * taps[tap]


@kernel
def delay_pings(record, bins_late, out):
    """Let every ping come later by its own number of bins, whole or not; energy in between is shared."""
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
