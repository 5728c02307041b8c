"""Range bins as a difference array of integers: densities step up and down, and a prefix sum turns steps into bins.

Integers cancel exactly: a bin without energy is exactly zero, and the sum is the same in any order. The next bin's
share of a step is rounded down, so that the step's own bin gets no less than its share and no bin is negative.

Spreading and absorption multiply the finished bins by their mean over each bin. What lies nearer than the centre of its
bin counts more before, and what lies farther less: to first order in the place within the bin.

Theory: docs/theory/sweep.md.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.compiler.jit import inlined, inlined_uncounted
from insonify.kernels.common.types import RangeDecay

FIXED_POINT = float(2**38)  # integers per unit of energy per bin
POINT = 1e-6  # bins; what is shorter lies at one place
MOST_DECAY = 2.0  # up to which no place within a bin counts less than nothing
MEAN_SQUARE = 5.0 / 96.0  # by which the mean of (1 + d t / 4)⁻⁴ over a bin exceeds 1, per d²


class RangeBins(NamedTuple):
    """Difference array of one side's range bins, and the decay of the range factor within them."""

    steps: NDArray[np.int64]  # (bins + 2,)
    decay: RangeDecay


def mean_over_centre(bins: int, decay: RangeDecay) -> NDArray[np.float64]:
    """Mean of the range factor over each bin, over its value at the centre of the bin, (bins,)."""
    found = np.minimum(decay.spreading / (np.arange(bins) + 0.5) + decay.loss, MOST_DECAY)
    return 1.0 + MEAN_SQUARE * found**2


@inlined
def relative_decay(decay, position):
    """Relative decrease of the range factor per bin, at a position in bins."""
    found = decay.spreading / position + decay.loss
    return found if found < MOST_DECAY else MOST_DECAY


@inlined
def range_weight(decay, k, position, span):
    """Mean range factor over a span of slant range, over its mean over bin k.

    Parameters
    ----------
    decay : RangeDecay
    k : int
        Bin in which the span lies.
    position, span : float
        Middle and length of the span, in bins; a single place has the length 0.
    """
    found = relative_decay(decay, k + 0.5)
    nearness = 1.0 / (1.0 + 0.25 * found * (position - k - 0.5))
    nearness *= nearness
    return nearness * nearness * (1.0 + MEAN_SQUARE * found * found * (span * span - 1.0))


@inlined_uncounted
def late_share(position, whole, decay):
    """Share of a step of density at a position that the bin after its own takes: docs/theory/sweep.md."""
    fraction = position - whole
    return fraction + 0.5 * relative_decay(decay, position) * (fraction - fraction * fraction)


@inlined_uncounted
def step_density(bins, position, change):
    """Change the density of energy from a position on."""
    if position < bins.steps.size - 2:
        k = int(position)
        late = np.int64(math.floor(late_share(position, k, bins.decay) * change))
        bins.steps[k] += change - late
        bins.steps[k + 1] += late


@inlined_uncounted
def add_energy(bins, position, energy):
    """Add an energy at one position."""
    if position < bins.steps.size - 2:
        k = int(position)
        whole = np.int64(energy * (1.0 - relative_decay(bins.decay, position) * (position - k - 0.5)))
        bins.steps[k] += whole
        bins.steps[k + 1] -= whole


@inlined_uncounted
def spread_energy(bins, near, far, energy):
    """Spread an energy evenly between two positions."""
    if far < near:
        near, far = far, near
    if far - near > POINT:
        density = np.int64(energy / (far - near))
        step_density(bins, near, density)
        step_density(bins, far, -density)
    else:
        add_energy(bins, near, energy)


@inlined_uncounted
def tilt_density(bins, near, far, density, change):
    """Turn an even density that has been deposited into a linear one of the same energy."""
    # Up to a border between bins the integral of the linear density exceeds that of the even one by a parabola, which
    # is zero at both ends: so much is moved from the bin behind the border to the one before it.
    gain, steps = 0.5 * density * change / (far - near), bins.steps
    for border in range(int(near) + 1, min(math.ceil(far), steps.size - 1)):
        moved = np.int64(gain * (border - near) * (border - far))
        steps[border - 1] += moved
        steps[border] -= 2 * moved
        steps[border + 1] += moved


@inlined_uncounted
def accumulate_bins(bins, factor, out):
    """Prefix-sum a difference array into intensities, apply what depends on range alone, and clear the array."""
    bins = bins.steps
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
        # Weights interpolated in a table may be negative by rounding; intensities are never below zero.
        out[k] = max(bins[k], np.int64(0)) * (factor[k] * (1.0 / FIXED_POINT))
        bins[k] = 0
    bins[out.size :] = 0
