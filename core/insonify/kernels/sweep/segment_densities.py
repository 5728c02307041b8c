"""Even densities of energy along a profile, put into range bins: one step a knot, shared by neighbouring segments.

Theory: docs/theory/sweep.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.bed.profile import padded_count


@inlined_uncounted
def deposit_densities(count, echoes, bin_length, bins):
    """Spread the energies of the segments of a profile over the range bins.

    Energies become whole numbers first, so that what a knot adds its neighbour takes away exactly.
    """
    knots = padded_count(count)
    _density_steps(knots, echoes.energy, echoes.early)
    _share_steps(knots, echoes.r, 1.0 / bin_length, bins.size - 2.0, echoes.early, echoes.late, echoes.place)
    _add_steps(count, echoes.place, echoes.early, echoes.late, bins)


@inlined_uncounted
def _density_steps(count, energy, change):
    """Change of the density of energy at each knot; beyond the last one there is no energy."""
    change[0] = np.int64(energy[0])
    for i in range(1, count):
        change[i] = np.int64(energy[i]) - np.int64(energy[i - 1])


@inlined_uncounted
def _share_steps(count, r, per_bin, last, early, late, place):
    """Share each step between the bin it falls in and the next.

    Where there is a hole in the bed position is NaN, which compares false, and there is nothing to share.
    """
    for i in range(count):
        position = r[i] * per_bin
        whole = math.floor(position)
        share = np.int64(math.floor((position - whole) * early[i]))
        share = share if early[i] != 0 else np.int64(0)
        late[i] = share
        early[i] -= share
        whole = whole if whole > 0.0 else 0.0
        place[i] = np.int32(whole if whole < last else last)


@inlined_uncounted
def _add_steps(count, place, early, late, bins):
    """Add each step to its bins, the places of which are whole numbers from 0."""
    for i in range(count):
        k = np.uint32(place[i])
        bins[k] += early[i]
        bins[k + np.uint32(1)] += late[i]
