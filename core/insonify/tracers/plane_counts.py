"""Number of planes of each ping: as many as bring the estimated error of the ping within a tolerance.

Theory: docs/theory/error.md.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats, Integers
from insonify.kernels.sweep.plane_errors import BEYOND, COLUMN, REGIONS

# Numbers of planes across a beam that are traced.
COUNTS = (*range(1, 9), *range(10, 17, 2), *range(20, 33, 4), *range(40, 65, 8), *range(80, 129, 16))
MOST_PLANES = COUNTS[-1]
MOST_GROWTH = 4.0  # of the number of planes from one trace of a ping to the next


class Goal(NamedTuple):
    """Error of a ping with which its tracing ends."""

    tolerance: float  # greatest error by planes, as a share of the ping
    trust: float = 1.0  # error over what planes estimate, measured on a few pings of the scene


def empty_squares(pings: int) -> Floats:
    """Squares of no error of pings, (n, 2, regions, 2), for sides that a tracer does not measure."""
    return np.zeros((pings, 2, REGIONS, 2))


def errors_of_sides(squares: Floats) -> Floats:
    """Estimated errors from squares of errors and records, (.., regions, 2): the greatest of three norms.

    Those are over the bins beyond 1.4 altitudes, over all from the first return of the bed, and over the water column.
    """
    norms = np.stack([squares[..., BEYOND, :], squares[..., COLUMN + 1 :, :].sum(axis=-2), squares[..., COLUMN, :]])
    missed, whole = norms[..., 0], norms[..., 1]
    found = np.sqrt(np.divide(missed, whole, out=np.zeros_like(missed), where=whole > 0.0))
    return np.asarray(np.where(np.isnan(found), np.inf, found).max(axis=0))


def trace_until(
    goal: Goal | None, planes: int, pings: int, trace_some: Callable[[Integers, int], Floats]
) -> tuple[Floats, Integers]:
    """Trace pings, and those of too great an error by more planes; return the squares of errors and the planes of each.

    Parameters
    ----------
    goal : Goal or None
        None traces every ping once.
    planes : int
        Planes that every ping is traced by at first.
    pings : int
        Number of pings.
    trace_some : callable
        Traces the pings at some places by a number of planes, and returns their squares of errors.
    """
    counts, squares = np.full(pings, planes, np.int64), trace_some(np.arange(pings), planes)
    while goal is not None and pings > 0:
        errors = goal.trust * errors_of_sides(squares.sum(axis=1))
        over = np.flatnonzero((errors > goal.tolerance) & (counts < MOST_PLANES))
        if over.size == 0:
            break
        growth = np.clip(errors[over] / goal.tolerance, 1.0, MOST_GROWTH)
        wanted = np.searchsorted(COUNTS, np.minimum(np.maximum(growth * counts[over], counts[over] + 1), MOST_PLANES))
        for place in np.unique(wanted):
            some = over[wanted == place]
            counts[some] = COUNTS[place]
            squares[some] = trace_some(some, COUNTS[place])
    return squares, counts
