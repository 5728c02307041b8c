"""Range bins as a difference array of integers: densities step up and down, and a prefix sum turns steps into bins.

Integers cancel exactly: a bin without energy is exactly zero, and the sum is the same in any order. The next bin's
share of a step is rounded down, so that the step's own bin gets no less than its share and no bin is negative.

Theory: docs/theory/sweep.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.compiler.jit import inlined_uncounted

FIXED_POINT = float(2**38)  # integers per unit of energy per bin


@inlined_uncounted
def step_density(bins, position, change, last):
    """Change the density of energy from a position on."""
    if position < last:
        k = int(position)
        late = np.int64(math.floor((position - k) * change))
        bins[k] += change - late
        bins[k + 1] += late


@inlined_uncounted
def spread_energy(bins, near, far, energy, last):
    """Spread an energy evenly between two positions."""
    if far < near:
        near, far = far, near
    if far - near > 1e-6:
        density = np.int64(energy / (far - near))
        step_density(bins, near, density, last)
        step_density(bins, far, -density, last)
    elif near < last:
        k = int(near)
        bins[k] += np.int64(energy)
        bins[k + 1] -= np.int64(energy)


@inlined_uncounted
def tilt_density(bins, near, far, density, change, last):
    """Turn an even density that has been deposited into a linear one of the same energy.

    Up to a border between bins the integral of the linear density exceeds that of the even one by a parabola, which is
    zero at both ends: so much is moved from the bin behind the border to the one before it.
    """
    gain = 0.5 * density * change / (far - near)
    for border in range(int(near) + 1, min(math.ceil(far), int(last) + 1)):
        moved = np.int64(gain * (border - near) * (border - far))
        bins[border - 1] += moved
        bins[border] -= 2 * moved
        bins[border + 1] += moved


@inlined_uncounted
def accumulate_bins(bins, factor, out):
    """Prefix-sum a difference array into intensities, apply what depends on range alone, and clear the array.

    Weights interpolated in a table may be negative by rounding; intensities are never below zero.
    """
    # Four stretches at once, each starting from the sum of those before it.
    quarter = out.size // 4
    two, three, four = 2 * quarter, 3 * quarter, 4 * quarter
    a, b, c, d = np.int64(0), np.int64(0), np.int64(0), np.int64(0)
    # A loop, because a kernel that calls `sum` takes 65 ms longer to load: Numba imports linear algebra for it.
    for k in range(quarter):
        b += bins[k]
        c += bins[quarter + k]
        d += bins[two + k]
    c += b
    d += c
    for k in range(quarter):
        a += bins[k]
        b += bins[quarter + k]
        c += bins[two + k]
        d += bins[three + k]
        bins[k], bins[quarter + k], bins[two + k], bins[three + k] = a, b, c, d
    for k in range(four, out.size):
        d += bins[k]
        bins[k] = d
    for k in range(out.size):
        out[k] = max(bins[k], np.int64(0)) * (factor[k] * (1.0 / FIXED_POINT))
        bins[k] = 0
    bins[out.size :] = 0
