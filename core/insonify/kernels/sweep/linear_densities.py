"""Densities of echoes that are linear in slant range, for whole segments along planes oblique to the grid.

The slope along such a plane changes within a cell, and with it the density of the echo. Derived in
docs/theory/sweep.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.bed.profile import padded_count
from insonify.kernels.common.jit import inlined_uncounted
from insonify.kernels.common.types import LIGHT

MOST_CHANGE = 1.9  # of a density that is positive at both ends: less than 2


@inlined_uncounted
def fit_densities(segments, profile, plane, law, r, change):
    """Relative change, from end to end, of the density of the echo of segments along an oblique plane.

    Derived in docs/theory/sweep.md.

    Parameters
    ----------
    segments : int
    profile : Profile
    plane : HalfPlane
        That of the profile.
    law : int
    r : ndarray of float64
        Slant range of the knots, m.
    change : ndarray
        Holds the power of cos²α with which the strength of each segment grows; takes the changes, as shares of the
        mean density.
    """
    x, z, slope, area = profile.x, profile.z, profile.slope, profile.area
    gradient, twist = profile.gradient, profile.twist
    real, along_y = change.dtype.type, abs(plane.ey) >= abs(plane.ex)
    eu, ev = (real(plane.ex), real(plane.ey)) if along_y else (real(plane.ey), real(plane.ex))
    half, one, two, four, most = real(0.5), real(1.0), real(2.0), real(4.0), real(MOST_CHANGE)
    per_ev_squared = one / (ev * ev)
    for i in range(segments):
        ground, height, rise = real(0.5 * (x[i] + x[i + 1])), real(0.5 * (z[i] + z[i + 1])), slope[i]
        run, lengthened = real(x[i + 1] - x[i]), real(r[i + 1] - r[i]) / real(0.5 * (r[i] + r[i + 1]))
        offset, approach, bent = height - rise * ground, ground + height * rise, eu * twist[i]
        turned = bent * ground
        # d ln A, d ln cos²α and d ln(dr/dx): docs/theory/sweep.md
        tilted = two * twist[i] * (gradient[i] + eu * per_ev_squared * (rise - eu * gradient[i])) / area[i]
        facing = -four * turned * offset / (offset * offset + turned * turned) - two * lengthened - tilted
        found = change[i] * facing
        if law != LIGHT:
            slowed = (run * (one + rise * rise) + two * bent * height) / approach - lengthened
            found += half * tilted - slowed
        found = found if found < most else most
        change[i] = found if found > -most else -most


@inlined_uncounted
def tilt_densities(segments, echoes, per_bin, last, bins):
    """Turn even densities into linear ones: move energy over the borders between bins that lie within a segment.

    Parameters
    ----------
    segments : int
    echoes : SegmentEchoes
        Its steps are used as work space.
    per_bin : float
        Bins per metre.
    last : float
        Last bin that may take a step, two less than the array's size.
    bins : ndarray of int64
        Difference array, which holds the even densities.
    """
    r, energy, change = echoes.r, echoes.energy, echoes.change
    over, place, moved = echoes.late, echoes.place, echoes.moved
    padded = padded_count(segments)
    energy[segments:padded] = 0.0  # what is left there of other profiles
    ahead, more = 1.0, True
    while more:
        more = _moves_over_border(padded, ahead, r, energy, change, per_bin, last, over, place)
        for i in range(segments):
            moved[np.uint32(place[i])] += over[i]
        ahead += 1.0
    _add_moves(moved, bins)


@inlined_uncounted
def _moves_over_border(segments, ahead, r, energy, change, per_bin, last, out, place):
    """Energy moved over the first, second … border within each segment; return whether any has a further one.

    Up to a border the integral of a linear density exceeds that of the even one by a parabola, zero at both ends.
    """
    more, half = 0, 0.5
    for i in range(segments):
        p, q = r[i] * per_bin, r[i + 1] * per_bin
        a, b = p if p < q else q, q if p < q else p
        border = math.floor(a) + ahead
        parabola = half * energy[i] * change[i] * (border - a) * (border - b) / (b - a)
        met = (border < b) & (border <= last) & (energy[i] != 0.0)
        out[i] = np.int64(parabola if met else 0.0)
        border = border if border < last else last
        place[i] = np.int32(border if border > 0.0 else 0.0)
        more |= 1 if met & (border + 1.0 < b) else 0
    return more != 0


@inlined_uncounted
def _add_moves(moved, bins):
    """Add what is moved over the borders between bins to the difference array, and clear it."""
    bins[0] += moved[1]
    for k in range(1, bins.size):
        bins[k] += moved[k + 1] - 2 * moved[k] + moved[k - 1]
    for k in range(moved.size):
        moved[k] = 0
