"""Work space for one profile of the bed, and how far the vectorised passes over it run."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from insonify.compiler.jit import inlined_uncounted

# Parts of a segment for which a profile has room, on average.
MEAN_PARTS = 12
# Entries of one vectorised pass. Passes run on to a whole multiple and leave garbage past the last entry, because a
# scalar loop over the remainder would take as long as many more entries together. Up to FEW entries a scalar loop wins.
AT_ONCE, FEW = 32, 8
WORD = 8  # marks of segments in an int64, tested at once


class Profile(NamedTuple):
    """One slice; n knots make n - 1 segments, arrays are longer than n."""

    x: NDArray[np.float64]  # ground range of the knots from the sonar, m
    z: NDArray[np.float64]  # height of the knots above the sonar, m
    slope: NDArray[np.float32]  # dz/dx of each segment
    area: NDArray[np.float32]  # 1 + |∇z|² at the middle of each segment: squared area over its level projection
    material: NDArray[np.int64]  # row of the reflectivity table, each segment
    gradient: NDArray[np.float32]  # ∂z across the strip of grid cells that a segment lies in, at its middle
    twist: NDArray[np.float32]  # change of that gradient along the segment
    parts: NDArray[np.int32]  # work space: parts into which each segment is divided
    low: NDArray[np.float32]  # work space of a strip: heights on its lower border
    high: NDArray[np.float32]  # and on its upper border
    across: NDArray[np.float32]  # and the gradient across it, at its knots
    cells: NDArray[np.int32]  # work space of an oblique plane: cell along u at each line v
    into: NDArray[np.float32]  # and how far into that cell the plane lies
    crossed: NDArray[np.int64]  # and how the plane crosses a line u between two lines v
    before: NDArray[np.float32]  # and differences across before the knots
    after: NDArray[np.float32]  # and beyond them
    range_ratio: NDArray[np.float32]  # in water that refracts: apparent ground range of the knots over the true one
    gain: NDArray[np.float32]  # and what their energy must be multiplied by
    facing: NDArray[np.float32]  # and of segments, -r√area cosα of the true incidence α, r the apparent slant range, m


@inlined_uncounted
def list_marked(marks, segments, indices):
    """List the indices of marked segments and return their number; a word of marks beyond the segments is cleared."""
    # Few segments are marked, so that whole words of marks are tested at once.
    marks[segments : segments + WORD] = False
    words, n = marks[: (segments + WORD - 1) // WORD * WORD].view(np.int64), 0
    for word in range(words.size):
        if words[word] != 0:
            for i in range(WORD * word, WORD * word + WORD):
                if marks[i]:
                    indices[n] = i
                    n += 1
    return n


def empty_profile(capacity: int, dtype: DTypeLike = np.float32) -> Profile:
    """Make room for profiles of at most ``capacity`` knots, in single precision or, to measure its error, in double."""
    x, z = np.zeros(capacity), np.zeros(capacity)
    slope, area, gradient, twist, low, high, across = np.zeros((7, capacity), dtype)
    into, before, after, range_ratio, gain, facing = np.zeros((6, capacity), dtype)
    (material, crossed), (parts, cells) = np.zeros((2, capacity), np.int64), np.zeros((2, capacity), np.int32)
    return Profile(
        x, z, slope, area, material, gradient, twist, parts, low, high, across, cells, into, crossed, before, after,
        range_ratio, gain, facing,
    )  # fmt: skip


def profile_capacity(reach: float, spacing: float) -> int:
    """Greatest number of knots of a slice over a ground range and a spacing of nodes, in m, with those inserted."""
    return int(MEAN_PARTS * 2.0 * math.sqrt(2.0) * reach / spacing) + 64 * AT_ONCE


@inlined_uncounted
def padded_count(entries):
    """Count the entries that a vectorised pass works on: up to a whole multiple of what it takes at a time."""
    return (entries + (AT_ONCE - 1)) // AT_ONCE * AT_ONCE if entries > FEW else entries
