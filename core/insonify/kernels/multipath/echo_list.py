"""A list of echoes on their way into the bins: where each begins and ends, how much it brings, who sent it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.contributors import open_contributor, spread_contribution
from insonify.kernels.common.jit import inlined, kernel
from insonify.kernels.common.range_bins import FIXED_POINT, spread_energy
from insonify.kernels.multipath.image_sources import PATH_COUNT

# Columns of a list.
NEAR, FAR, ENERGY, RISE, TILT, GROUND_RANGE, COSINE, WHO, COLUMNS = 0, 1, 2, 3, 4, 5, 6, 7, 8
ROOM = 16384
ENOUGH = 4096  # echoes after which a list is entered, with room for what comes before that is asked


def empty_echo_list() -> NDArray[np.float64]:
    """Make room for a list."""
    return np.zeros((ROOM, COLUMNS))


@inlined
def list_echo(echoes, n, near, far, energy, rise, tilt, x, cosine, who):
    """Add an echo, in metres of slant range, and what waves add to it; return the number of them.

    ``rise`` is the slant range that a wave of rms height adds, ``tilt`` what a tilt of one standard deviation does.
    """
    if not energy > 0.0 or n >= ROOM:
        return n
    echo = echoes[n]
    echo[NEAR], echo[FAR], echo[ENERGY], echo[RISE], echo[TILT] = near, far, energy, rise, tilt
    echo[GROUND_RANGE], echo[COSINE], echo[WHO] = x, cosine, who
    return n + 1


@kernel
def deposit_echoes(echoes, n, facets, bin_length, path, bins, contributions, labelling):
    """Spread the first ``n`` echoes over the bins, facet by facet; if asked to, tell the ledger who and which way."""
    last, per_bin, share = bins.size - 2, 1.0 / bin_length, FIXED_POINT / facets.shape[0]
    first_row = path * (contributions.present.size // PATH_COUNT) if labelling else 0
    for k in range(n):
        near, far = min(echoes[k, NEAR], echoes[k, FAR]), max(echoes[k, NEAR], echoes[k, FAR])
        energy, rise, tilt = echoes[k, ENERGY] * share, echoes[k, RISE], echoes[k, TILT]
        for f in range(facets.shape[0]):
            start = max(near + rise * facets[f, 0] + tilt * facets[f, 2], 0.0)
            stop = max(far + rise * facets[f, 1] + tilt * facets[f, 3], start)
            spread_energy(bins, start * per_bin, stop * per_bin, energy, last)
            if labelling:
                row = first_row + int(echoes[k, WHO])
                open_contributor(contributions, row)
                spread_contribution(
                    contributions, row, start, stop, energy, echoes[k, GROUND_RANGE], echoes[k, COSINE], bin_length
                )
