"""Number of planes of each ping: as many as bring the estimated error of the ping within a tolerance.

Theory: docs/theory/error.md.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.sweep.plane_errors import BEYOND, COLUMN, REGIONS
from insonify.kernels.sweep.sweep import LaidPlanes
from insonify.tracers.target_planes import find_pings_met

AnyArray = NDArray[Any]
Columns = tuple[AnyArray, ...]
# Numbers of planes across a beam that are traced.
COUNTS = (*range(1, 9), *range(10, 17, 2), *range(20, 33, 4), *range(40, 65, 8), *range(80, 129, 16))
MOST_PLANES = COUNTS[-1]
MOST_GROWTH = 4.0  # of the number of planes from one trace of a ping to the next


class TracedPings(NamedTuple):
    """Traced pings with the errors of their planes."""

    echoes: AnyArray  # (n, 2, bins) mean energies, or waves of the samples of bins
    squares: Floats  # (n, 2, regions, 2) of errors and of the record, as `errors_of_sides` takes them
    planes: Integers  # (n,) planes across the beam
    bin_errors: Singles  # (n, 2, bins) errors of bins by planes, as intensities; without bins if they are not found


class Trust(NamedTuple):
    """Error over what planes estimate."""

    alone: float = 1.0  # of pings that show the bed alone
    met: float = 1.0  # of pings of which planes may cut targets

    def of(self, arrays: SceneArrays, poses: Poses, laid: LaidPlanes) -> Floats:
        """Return that of each ping, (n,)."""
        if self.alone == self.met:
            return np.full(poses.x.size, self.alone)
        return np.where(find_pings_met(arrays, poses, laid), self.met, self.alone)


AS_ESTIMATED = Trust()


class Goal(NamedTuple):
    """Error of a ping with which its tracing ends."""

    tolerance: float  # greatest error by planes, as a share of the ping
    trust: Trust  # measured on a few pings of the scene


def empty_squares(pings: int) -> Floats:
    """Squares of no error of pings, (n, 2, regions, 2), for sides that a tracer does not measure."""
    return np.zeros((pings, 2, REGIONS, 2))


def empty_bin_errors(pings: int, bins: int = 0) -> Singles:
    """Errors of no bins of pings, (n, 2, 0), or room for the errors of some."""
    return np.zeros((pings, 2, bins), np.float32)


def errors_of_sides(squares: Floats) -> Floats:
    """Estimated errors from squares of errors and records, (.., regions, 2): the greatest of three norms.

    Those are over the bins beyond 1.4 altitudes, over all from the first return of the bed, and over the water column.
    """
    column = _root_of_ratio(squares[..., COLUMN, :])
    return np.asarray(np.maximum(errors_over_bed(squares), column))


def errors_over_bed(squares: Floats) -> Floats:
    """Estimated errors as `errors_of_sides` has them, without that over the water column."""
    beyond, bed = squares[..., BEYOND, :], squares[..., COLUMN + 1 :, :].sum(axis=-2)
    return np.asarray(np.maximum(_root_of_ratio(beyond), _root_of_ratio(bed)))


def _root_of_ratio(squares: Floats) -> Floats:
    """Root of the ratio of squares, 0 where the record is zero and infinite where the error is not known."""
    missed, whole = squares[..., 0], squares[..., 1]
    found = np.sqrt(np.divide(missed, whole, out=np.zeros_like(missed), where=whole > 0.0))
    return np.where(np.isnan(found), np.inf, found)


def more_across(planes: Integers, first: int, across: int) -> Integers:
    """Planes across each target of pings with more planes than the first number of them: by the root of both."""
    return across * np.maximum(np.rint(np.sqrt(planes / first)), 1.0).astype(np.int64)


def trace_until(
    goal: Goal | None, first: int, pings: int, trace_some: Callable[[Integers, Integers], Columns]
) -> tuple[Columns, Integers]:
    """Trace pings, and pings of too great an error by more planes; return what is traced and the planes of each.

    Parameters
    ----------
    goal : Goal or None
        None traces every ping once.
    first : int
        Planes that every ping is traced by at first.
    pings : int
        Number of pings.
    trace_some : callable
        Traces the pings at some places, each by a number of planes; returns arrays of them, the squares of errors last.
    """
    planes = np.full(pings, first, np.int64)
    columns = trace_some(np.arange(pings), planes)
    while goal is not None and pings > 0:
        errors = errors_of_sides(columns[-1].sum(axis=1))
        over = np.flatnonzero((errors > goal.tolerance) & (planes < MOST_PLANES))
        if over.size == 0:
            break
        growth = np.clip(errors[over] / goal.tolerance, 1.0, MOST_GROWTH)
        least = np.minimum(np.maximum(growth * planes[over], planes[over] + 1), MOST_PLANES)
        planes[over] = np.asarray(COUNTS)[np.searchsorted(COUNTS, least)]
        for column, part in zip(columns, trace_some(over, planes[over])):
            column[over] = part
    return columns, planes
