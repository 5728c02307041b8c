"""Stability case: an input on which a common method fails, beside the method that this program uses."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Approach:
    """Method and its measured error."""

    does: str  # what the method does, as a sentence
    error: Callable[[], float]  # measures its error in the case's unit; NaN where the method gives no number
    bound: float  # bound that the failing method exceeds and the right one keeps


@dataclass(frozen=True)
class StabilityCase:
    """Failure of a common method beside the method that avoids it."""

    name: str  # name of the failure
    trigger: str  # cause of the failure, in one sentence
    figure: str  # quantity that is measured
    unit: str  # unit of that quantity, empty for a pure number
    failing: Approach  # common method, and the method of this program
    right: Approach
    picture: Callable[[Figure], None]  # draws both on an empty figure
    scene: str = ""  # name of the bundled scene of the measurement; empty if there is none


@dataclass(frozen=True)
class StabilityTheme:
    """Cases about one subject."""

    title: str  # heading on the page
    place: int  # place on the page; themes stand in the order of these numbers
    cases: tuple[StabilityCase, ...]  # cases in order


@dataclass(frozen=True)
class Outcome:
    """Measured errors of a case."""

    case: StabilityCase
    failing: float  # errors of its two methods
    right: float

    @property
    def is_shown(self) -> bool:
        """Whether the failing method exceeds its bound; a method without a number does."""
        return not self.failing <= self.case.failing.bound

    @property
    def is_held(self) -> bool:
        """Whether the right method keeps its bound."""
        return self.right <= self.case.right.bound

    @property
    def verdict(self) -> str:
        """Verdict in a few words."""
        if not self.is_held:
            return "does not hold"
        return "holds" if self.is_shown else "holds, failure not shown"


def measure_case(case: StabilityCase) -> Outcome:
    """Measure both methods of a case."""
    return Outcome(case, float(case.failing.error()), float(case.right.error()))


def format_quantity(value: float, unit: str) -> str:
    """Format a quantity with its unit."""
    if math.isnan(value):
        return "not a number"
    after = f" {unit}" if unit else ""
    if math.isinf(value):
        return f"infinite{after}"
    if value == 0.0 or 1e-3 <= abs(value) < 1e5:
        return f"{float(f'{value:.3g}'):g}{after}".replace("-", "−")
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa} × 10{str(int(exponent)).translate(RAISED)}{after}"
