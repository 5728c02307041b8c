"""Densities of energy along a profile, put into range bins: one step a knot, shared by neighbouring segments.

Densities are even, or linear in slant range for whole segments along planes oblique to the grid: the slope along such a
plane changes within a cell, and with it the density of the echo. Derived in docs/theory/sweep.md.
"""

import math

import numpy as np

from insonify.compiler.jit import inlined_uncounted
from insonify.kernels.bed.profile import list_marked, padded_count
from insonify.kernels.common.range_bins import late_share
from insonify.kernels.common.types import LIGHT

MOST_CHANGE = 1.9  # of a density that is positive at both ends: less than 2


@inlined_uncounted
def deposit_densities(count, echoes, bin_length, bins):
    """Spread the energies of the segments of a profile over the range bins."""
    # Energies become whole numbers first, so that what a knot adds its neighbour takes away exactly.
    knots, last, steps = padded_count(count), bins.steps.size - 2.0, (echoes.early, echoes.late)
    _density_steps(knots, echoes.energy, echoes.early)
    _share_steps(knots, echoes.r, 1.0 / bin_length, last, bins.decay, steps, echoes.place)
    _add_even_steps(count, echoes.place, echoes.early, echoes.late, bins.steps)


@inlined_uncounted
def _density_steps(count, energy, change):
    """Change of the density of energy at each knot; beyond the last one there is no energy."""
    change[0] = np.int64(energy[0])
    for i in range(1, count):
        change[i] = np.int64(energy[i]) - np.int64(energy[i - 1])


@inlined_uncounted
def _share_steps(count, r, per_bin, last, decay, steps, place):
    """Share each step between the bin it falls in and the next."""
    # Where there is a hole in the bed position is NaN, which compares false, and there is nothing to share.
    early, late = steps
    for i in range(count):
        position = r[i] * per_bin
        whole = math.floor(position)
        share = np.int64(math.floor(late_share(position, whole, decay) * early[i]))
        share = share if early[i] != 0 else np.int64(0)
        late[i] = share
        early[i] -= share
        whole = whole if whole > 0.0 else 0.0
        place[i] = np.int32(whole if whole < last else last)


@inlined_uncounted
def _add_even_steps(count, place, early, late, bins):
    """Add each step to its bins, the places of which are whole numbers from 0."""
    for i in range(count):
        k = np.uint32(place[i])
        bins[k] += early[i]
        bins[k + np.uint32(1)] += late[i]


@inlined_uncounted
def fit_densities(segments, profile, plane, law, r, change):
    """Relative change, from end to end, of the density of the echo of segments along an oblique plane."""
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
def deposit_linear_densities(count, echoes, bin_length, bins):
    """Spread the energies of the segments of an oblique profile over the range bins, with densities linear in range."""
    # Over a border between bins that lies within a segment a linear density moves energy from the bin behind it to the
    # one before it. What a knot's step and the first two borders of its segment add to four bins is worked out for all
    # knots at once; further borders, and those of segments that come nearer outwards, follow one by one.
    r, energy, change, place = echoes.r, echoes.energy, echoes.change, echoes.place
    steps = echoes.early, echoes.late, echoes.third, echoes.fourth
    per_bin, last = 1.0 / bin_length, bins.steps.size - 2.0
    _work_out_steps(padded_count(count), r, energy, change, per_bin, last, bins.decay, steps, place)
    _add_steps(count, place, steps, echoes.even, echoes.odd)
    _merge_steps(count, place, echoes.even, echoes.odd, bins.steps)
    _mark_remaining(padded_count(count), energy, place, echoes.beyond)
    for k in range(list_marked(echoes.beyond, count - 1, echoes.marked)):
        _move_over_borders(np.uint64(echoes.marked[k]), r, energy, change, per_bin, last, bins.steps)


@inlined_uncounted
def _work_out_steps(knots, r, energy, change, per_bin, last, decay, steps, place):
    """Work out what each knot adds to its own bin and the next three, its segment's first two borders included."""
    # Up to a border the integral of a linear density exceeds that of the even one by a parabola, zero at both ends.
    early, late, third, fourth = steps
    real = energy.dtype.type
    nothing, half, one, two, none = real(0.0), real(0.5), real(1.0), real(2.0), np.int64(0)
    for i in range(knots):
        position = r[i] * per_bin
        whole = math.floor(position)
        begin, end, room = real(position - whole), real(r[i + 1] * per_bin - whole), real(last - whole)
        step = np.int64(energy[i]) - (np.int64(energy[i - 1]) if i > 0 else none)
        share = np.int64(math.floor(late_share(position, whole, decay) * step))
        share = share if step != 0 else none
        curve, within = half * energy[i] * change[i] / (end - begin), (energy[i] != nothing) & (end > begin)
        first = np.int64(curve * (one - begin) * (one - end) if within & (end > one) & (room >= one) else nothing)
        second = np.int64(curve * (two - begin) * (two - end) if within & (end > two) & (room >= two) else nothing)
        early[i], late[i] = step - share + first, share + second - 2 * first
        third[i], fourth[i] = first - 2 * second, second
        whole = whole if whole > 0.0 else 0.0
        place[i] = np.int32(whole if whole < last else last)


@inlined_uncounted
def _add_steps(count, place, steps, even, odd):
    """Add what knots add to their bins to two difference arrays by turns, so that neighbours need not wait."""
    for pair in range(count // 2):
        i = np.uint64(2 * pair)
        _add_step(i, place, steps, even)
        _add_step(i + np.uint64(1), place, steps, odd)
    if count % 2 != 0:
        _add_step(np.uint64(count - 1), place, steps, even)


@inlined_uncounted
def _add_step(i, place, steps, bins):
    """Add what one knot adds to four bins."""
    early, late, third, fourth = steps
    k = np.uint64(np.uint32(place[i]))
    bins[k] += early[i]
    bins[k + np.uint64(1)] += late[i]
    bins[k + np.uint64(2)] += third[i]
    bins[k + np.uint64(3)] += fourth[i]


@inlined_uncounted
def _merge_steps(count, place, even, odd, bins):
    """Add two difference arrays, where the places of knots have filled them, to a third, and clear them."""
    nearest = farthest = place[0]
    for i in range(count):
        nearest = place[i] if place[i] < nearest else nearest
        farthest = place[i] if place[i] > farthest else farthest
    # Each knot fills four bins; past the array's end they hold nothing.
    end = min(np.int64(farthest) + 4, bins.size)
    taken, one, other = bins[nearest:end], even[nearest:end], odd[nearest:end]
    for k in range(taken.size):
        taken[k] += one[k] + other[k]
        one[k] = 0
        other[k] = 0


@inlined_uncounted
def _mark_remaining(segments, energy, place, beyond):
    """Mark the segments with a third border, and those that come nearer outwards."""
    for i in range(segments):
        # Unsigned, what is below zero is more than two.
        beyond[i] = (np.uint32(place[i + 1] - place[i]) > np.uint32(2)) & (energy[i] != 0.0)


@inlined_uncounted
def _move_over_borders(i, r, energy, change, per_bin, last, bins):
    """Move energy over the third and further borders within a segment, over all if it comes nearer outwards."""
    p, q = r[i] * per_bin, r[i + np.uint64(1)] * per_bin
    a, b = min(p, q), max(p, q)
    curve, border = 0.5 * energy[i] * change[i] / (b - a), math.floor(a) + (3.0 if p < q else 1.0)
    while border < b and border <= last:
        moved, k = np.int64(curve * (border - a) * (border - b)), np.uint64(border)
        bins[k - np.uint64(1)] += moved
        bins[k] -= 2 * moved
        bins[k + np.uint64(1)] += moved
        border += 1.0
