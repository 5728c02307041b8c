"""List of echoes by way of the sea surface, each with its slant ranges, energy and contributor.

Waves spread every echo in range: each facet of the sea surface takes its share of the energy at its own delay.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_uncounted, kernel_uncounted
from insonify.kernels.common.contributors import ContributorTable, open_contributor, spread_contribution
from insonify.kernels.common.range_bins import FIXED_POINT, RangeBins, spread_energy
from insonify.kernels.multipath.image_sources import PATH_COUNT

# Columns of a list.
NEAR, FAR, ENERGY, RISE, TILT, GROUND_RANGE, COSINE, CONTRIBUTOR, COLUMNS = 0, 1, 2, 3, 4, 5, 6, 7, 8
ROOM = 16384
ENOUGH = 4096  # echoes after which a list is deposited; the room left takes those before the next check


class SurfaceEcho(NamedTuple):
    """One echo by way of the sea surface."""

    near: float  # slant range at which it begins over a flat sea, m
    far: float  # and ends
    energy: float
    rise: float  # slant range that a wave of rms height adds, m
    tilt: float  # slant range that a tilt of one standard deviation adds, m
    x: float  # ground range, m
    cosine: float  # of the incidence
    contributor: int


class EchoSink(NamedTuple):
    """Range bins and contributors that take the echoes of one side of one ping."""

    bins: RangeBins
    contributions: ContributorTable
    labelling: bool  # whether contributors are noted


def empty_echo_list() -> NDArray[np.float64]:
    """Make room for a list of echoes, (ROOM, COLUMNS)."""
    return np.zeros((ROOM, COLUMNS))


@inlined_uncounted
def list_echo(echoes, n, echo):
    """Append an echo to a list, if it brings energy and there is room."""
    if not echo.energy > 0.0 or n >= ROOM:
        return n
    row = echoes[n]
    row[NEAR], row[FAR], row[ENERGY], row[RISE], row[TILT] = echo.near, echo.far, echo.energy, echo.rise, echo.tilt
    row[GROUND_RANGE], row[COSINE], row[CONTRIBUTOR] = echo.x, echo.cosine, echo.contributor
    return n + 1


@kernel_uncounted
def deposit_echoes(echoes, n, facets, bin_length, path, sink):
    """Spread listed echoes over the range bins, facet by facet of the sea surface, and note their contributors."""
    bins, contributions, labelling = sink.bins, sink.contributions, sink.labelling
    per_bin, share = 1.0 / bin_length, FIXED_POINT / facets.shape[0]
    first_row = path * (contributions.present.size // PATH_COUNT) if labelling else 0
    for k in range(n):
        near, far = min(echoes[k, NEAR], echoes[k, FAR]), max(echoes[k, NEAR], echoes[k, FAR])
        energy, rise, tilt = echoes[k, ENERGY] * share, echoes[k, RISE], echoes[k, TILT]
        for f in range(facets.shape[0]):
            start = max(near + rise * facets[f, 0] + tilt * facets[f, 2], 0.0)
            stop = max(far + rise * facets[f, 1] + tilt * facets[f, 3], start)
            spread_energy(bins, start * per_bin, stop * per_bin, energy)
            if labelling:
                row, x, cosine = first_row + int(echoes[k, CONTRIBUTOR]), echoes[k, GROUND_RANGE], echoes[k, COSINE]
                open_contributor(contributions, row)
                spread_contribution(contributions, row, start, stop, energy, x, cosine, bin_length)
