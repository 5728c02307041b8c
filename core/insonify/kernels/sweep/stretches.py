"""Stretches: small parts of bed or target that echo in one plane, and where they are put.

The walk of a plane lists stretches, each with an energy that is spread evenly between two slant ranges. A sink then
puts the list into range bins and, where labels are wanted, into the shares of its contributors. Waves spread every
echo in range: each facet of the sea surface takes its share of the energy at its own delay.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import NOTHING, inlined_uncounted, kernel_on_demand, kernel_uncounted
from insonify.kernels.common.contributors import (
    ContributorTable,
    SpreadEcho,
    contributor_row,
    open_contributor,
    spread_echo,
)
from insonify.kernels.common.range_bins import FIXED_POINT, POINT, RangeBins, spread_energy

# Columns of a list.
NEAR, FAR, ENERGY, X_FROM, X_TO, COSINE, OWNER, RISE, TILT, COLUMNS = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
ROOM = 16384
ENOUGH = 512  # stretches after which a list is put into its sink; the room left takes those of one segment or cell


class Stretch(NamedTuple):
    """A part of bed or target whose energy is spread evenly over slant range."""

    near: float  # slant range at which its echo begins over a calm sea, m
    far: float  # and ends
    energy: float
    x_from: float  # true ground range there, m
    x_to: float
    cosine: float  # of the incidence, the lesser one of two
    owner: int  # contributor by one path; of bed that a target hides, row of that target's shadow
    rise: float  # slant range that a wave of rms height adds, m
    tilt: float  # slant range that a tilt of one standard deviation adds, m


class StretchSink(NamedTuple):
    """Where the stretches of one side of one ping are put."""

    bins: RangeBins
    contributions: ContributorTable
    labelling: bool  # whether contributors are noted


def empty_stretch_list() -> NDArray[np.float64]:
    """Make room for a list of stretches, (ROOM, COLUMNS)."""
    return np.zeros((ROOM, COLUMNS))


@inlined_uncounted
def list_stretch(rows, n, stretch, is_detailed):
    """Append a stretch to a list, if it brings energy and there is room; return their number."""
    if n >= ROOM:
        return n
    row = rows[n]
    row[NEAR], row[FAR], row[ENERGY] = stretch.near, stretch.far, stretch.energy
    if is_detailed:
        row[X_FROM], row[X_TO], row[COSINE], row[OWNER] = stretch.x_from, stretch.x_to, stretch.cosine, stretch.owner
        row[RISE], row[TILT] = stretch.rise, stretch.tilt
    # Whether there is energy is chance: without a branch the next row takes its place.
    return n + (1 if stretch.energy > 0.0 else 0)


@kernel_uncounted
def sink_stretches(rows, n, waves, bin_length, path, sink):
    """Put listed stretches by one path into a sink; ``waves`` are the facets of the sea surface on the way."""
    if sink.labelling:
        note_stretches(rows, n, waves, bin_length, path, sink.contributions)
    per_bin, share = 1.0 / bin_length, FIXED_POINT / max(waves.shape[0], 1)
    for k in range(n):
        energy = rows[k, ENERGY] * share
        if sink.labelling and rows[k, OWNER] >= sink.contributions.first_hidden:
            continue
        if waves.shape[0] == 0:
            spread_energy(sink.bins, rows[k, NEAR] * per_bin, rows[k, FAR] * per_bin, energy)
        for f in range(waves.shape[0]):
            start, stop = _delayed(rows[k], waves[f])
            spread_energy(sink.bins, start * per_bin, stop * per_bin, energy)


@inlined_uncounted
def _delayed(row, facet):
    """Slant ranges between which a stretch echoes by one facet of the sea surface."""
    near, far = min(row[NEAR], row[FAR]), max(row[NEAR], row[FAR])
    start = max(near + row[RISE] * facet[0] + row[TILT] * facet[2], 0.0)
    return start, max(far + row[RISE] * facet[1] + row[TILT] * facet[3], start)


@kernel_on_demand(NOTHING)
def note_stretches(rows, n, waves, bin_length, path, contributions):
    """Note the contributors of listed stretches by one path."""
    per_bin, share, before = 1.0 / bin_length, FIXED_POINT / max(waves.shape[0], 1), -1
    own = contributor_row(contributions, 0)
    for k in range(n):
        row, owner = rows[k], int(rows[k, OWNER])
        if owner != before:
            before = owner
            owner += path * contributions.per_path if owner < contributions.first_hidden else 0
            open_contributor(contributions, owner)
            own = contributor_row(contributions, owner)
        x, change = row[X_FROM], row[X_TO] - row[X_FROM]
        if row[FAR] < row[NEAR]:
            x, change = row[X_TO], -change
        for f in range(max(waves.shape[0], 1)):
            start, stop = min(row[NEAR], row[FAR]), max(row[NEAR], row[FAR])
            if waves.shape[0] > 0:
                start, stop = _delayed(row, waves[f])
            start, stop = start * per_bin, max(stop * per_bin, start * per_bin + POINT)
            per_length = 1.0 / (stop - start)
            run, facing = change * per_length, row[COSINE] * 0.5 * (start + stop)
            spread_echo(own, SpreadEcho(start, stop, row[ENERGY] * share * per_length, x - start * run, run, facing))


@kernel_on_demand(NOTHING)
def note_whole_segments(x, r, range_ratio, material, cos_squared, density, count, path, bin_length, contributions):
    """Note every segment of a profile that is visible whole; its energy is spread evenly over its slant range."""
    per_bin, first_row, row = 1.0 / bin_length, path * contributions.per_path, -1
    own = contributor_row(contributions, 0)
    for i in range(count - 1):
        if density[i] == 0.0:
            continue
        if first_row + material[i] != row:
            row = first_row + material[i]
            open_contributor(contributions, row)
            own = contributor_row(contributions, row)
        near, far = r[i] * per_bin, r[i + 1] * per_bin
        a, b = min(near, far), max(near, far)
        # Without refraction there are no ratios.
        ratio = 0.5 * (range_ratio[i] + range_ratio[i + 1]) if range_ratio.size > 0 else 1.0
        run = (x[i + 1] - x[i]) / ((far - near) * ratio)
        # The cosine of the incidence is inverse to the slant range along a segment.
        facing = math.sqrt(cos_squared[i]) * 0.5 * (a + b)
        spread_echo(own, SpreadEcho(a, b, abs(np.float64(density[i])), x[i] / ratio - near * run, run, facing))
