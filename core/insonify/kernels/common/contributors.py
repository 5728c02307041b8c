"""Shares of contributors (materials of the bed, targets) in the energy of every range bin of one side of a ping.

Bed that a target hides contributes to that target's shadow: the echo that it would return without the targets.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined_before_typing, inlined_uncounted

# In bins: an echo counts in every bin that it touches within rounding, so that every bin with energy has a contributor.
ROUNDING = 1e-3
FEW = 3  # range bins that most segments touch at most
NOT_TOUCHED = -2.0  # energy in a bin that an echo does not reach, less than that of any echo and of none


class ContributorTable(NamedTuple):
    """Energy of every contributor in the range bins of one side; a row is valid once its contributor is present.

    There is a row for each contributor by each path, then one for the shadow of each target.
    """

    per_path: int  # contributors by one path
    first_hidden: int  # row of the first target's shadow
    present: NDArray[np.bool_]  # (rows,)
    energy: NDArray[np.float64]  # (rows, bins) in fixed-point units
    strongest: NDArray[np.float64]  # energy of the contributor's strongest echo, below 0 for none
    x: NDArray[np.float32]  # ground range of that echo, m
    cosine: NDArray[np.float32]  # of the incidence there


def empty_contributor_table(materials: int, targets: int, paths: int, bins: int) -> ContributorTable:
    """Make room for one side of a ping: materials and targets by every path and shadows of targets, over range bins."""
    # Memory of contributors that never occur is never touched.
    per_path, first_hidden = materials + targets, paths * (materials + targets)
    energy, strongest = np.empty((2, first_hidden + targets, bins))
    x, cosine = np.empty((2, first_hidden + targets, bins), np.float32)
    return ContributorTable(
        per_path, first_hidden, np.zeros(first_hidden + targets, np.bool_), energy, strongest, x, cosine
    )


@inlined_uncounted
def open_contributor(contributions, who):
    """Clear a contributor's row if it is not present yet, and mark it present."""
    if not contributions.present[who]:
        contributions.present[who] = True
        contributions.energy[who, :] = 0.0
        contributions.strongest[who, :] = -1.0


class SpreadEcho(NamedTuple):
    """Echo of a part of bed or target that is spread evenly over slant range; slant ranges are in bins."""

    near: float
    far: float
    density: float  # per bin, in fixed-point units
    x: float  # true ground range at slant range 0, m
    run: float  # and its change per bin
    facing: float  # cosine of the incidence times slant range


@inlined_before_typing
def contributor_row(contributions, who):
    """One contributor's row of a table."""
    per_path, first_hidden, present, energy, strongest, x, cosine = contributions
    return ContributorTable(per_path, first_hidden, present, energy[who], strongest[who], x[who], cosine[who])


@inlined_uncounted
def spanned_bins(near, far, bins):
    """First range bin that a stretch of slant range, in bins, touches within rounding, and the one after its last."""
    if not near < bins:  # or NaN, a hole in the bed
        return 0, 0
    return max(int(near - ROUNDING), 0), int(min(far + ROUNDING, bins - 1.0)) + 1


@inlined_uncounted
def add_contribution(contributions, who, k, energy, x, cosine):
    """Add energy to a contributor's share in one range bin, and keep where its strongest echo comes from."""
    contributions.energy[who, k] += energy
    if energy > contributions.strongest[who, k]:
        contributions.strongest[who, k], contributions.x[who, k], contributions.cosine[who, k] = energy, x, cosine


@inlined_uncounted
def spread_echo(own, echo):
    """Add an echo that is spread evenly to a contributor's share in the bins that it touches."""
    bins = own.energy.size
    first, last = spanned_bins(echo.near, echo.far, bins)
    if last - first > FEW or first + FEW > bins:
        for k in range(first, last):
            _add_in_bin(own, np.uint64(k), True, echo)
    else:
        # So many whatever the segment: a loop of any length costs more than the bins that it leaves out.
        for k in range(FEW):
            _add_in_bin(own, np.uint64(first + k), first + k < last, echo)


@inlined_uncounted
def _add_in_bin(own, k, touched, echo):
    """Add the part of an evenly spread echo that lies in bin k (branch-free: the branch is unpredictable)."""
    start, stop = max(echo.near, np.float64(k)), min(echo.far, np.float64(k) + 1.0)
    part, middle = echo.density * max(stop - start, 0.0), 0.5 * (start + stop)
    part = part if touched else NOT_TOUCHED
    x_here, cosine_here = np.float32(echo.x + echo.run * middle), np.float32(echo.facing / middle)
    strongest, x, cosine = own.strongest[k], own.x[k], own.cosine[k]
    stronger = part > strongest
    own.energy[k] += max(part, 0.0)
    own.strongest[k] = part if stronger else strongest
    own.x[k] = x_here if stronger else x
    own.cosine[k] = cosine_here if stronger else cosine
