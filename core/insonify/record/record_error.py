"""Estimated error of a record, and a warning of pings that even the most planes do not bring within the tolerance."""

import math
from dataclasses import dataclass

import numpy as np

from insonify.arrays import Floats, Integers
from insonify.errors import PlanWarning, warn_caller
from insonify.planning.plan_entries import percent
from insonify.tracers.plane_counts import MOST_PLANES

UNIT, GREATEST_ERROR = 2.0**40, 1e3  # squares of errors are counted in 2⁻⁴⁰; greatest error that counts


@dataclass
class RecordError:
    """Estimated errors of the pings of a record so far."""

    tolerance: float
    known: int = 0  # pings of a known error
    squares: int = 0  # of their errors, in all: whole numbers, the sum of which is the same in blocks of any size
    over: int = 0  # pings whose error exceeds the tolerance with the most planes
    worst: tuple[float, int] = (0.0, -1)  # the greatest error of those, and its ping

    def add(self, pings: Integers, errors: Floats, planes: Integers) -> None:
        """Add pings by their numbers, their estimated errors and the planes that they are traced by."""
        known = np.minimum(errors[~np.isnan(errors)].astype(np.float64), GREATEST_ERROR)
        self.known += known.size
        self.squares += int(np.rint(UNIT * known * known).astype(np.int64).sum())
        over = np.flatnonzero((planes >= MOST_PLANES) & (errors > self.tolerance))
        self.over += over.size
        self.worst = max([self.worst, *((float(errors[k]), int(pings[k])) for k in over)])

    @property
    def whole(self) -> float:
        """Root of the mean square of the errors; NaN where none is known."""
        return math.sqrt(self.squares / UNIT / self.known) if self.known else float("nan")

    def warn(self) -> None:
        """Warn of the pings whose error exceeds the tolerance."""
        if self.over == 0:
            return
        error, ping = self.worst
        pings = "ping has" if self.over == 1 else "pings have"
        beyond = f"beyond the tolerance of {percent(self.tolerance)} with {MOST_PLANES} planes"
        remedy = "raise the tolerance, or leave such pings out by the variable 'error'"
        worst = f"the greatest is ping {ping} with {percent(error)}"
        warn_caller(PlanWarning(f"{self.over} {pings} an estimated error {beyond}, {worst}; {remedy}"))
