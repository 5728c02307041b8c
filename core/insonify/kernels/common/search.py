"""Search in ascending numbers."""

from insonify.compiler.jit import inlined_uncounted


@inlined_uncounted
def last_not_above(edges, x):
    """Find the last of ascending numbers that is not above another one, by bisection."""
    # A kernel that calls `numpy.searchsorted` takes 65 ms longer to load, because Numba imports linear algebra for it.
    low, high = -1, edges.size
    while high - low > 1:
        middle = (low + high) // 2
        if edges[middle] <= x:
            low = middle
        else:
            high = middle
    return low
