"""Stability case: an input on which a common method fails, beside the method that this program uses."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Measured(NamedTuple):
    """Errors of both methods of a case, in its unit; NaN where a method gives no number."""

    failing: float
    right: float
    picture: Callable[[Figure], object]  # draws both on an empty figure

    @classmethod
    def by(
        cls, error: Callable[[Any], float], failing: object, right: object, picture: Callable[[Figure], object]
    ) -> Measured:
        """Measure the results of both methods by the same error."""
        return cls(float(error(failing)), float(error(right)), picture)


class Quantity(NamedTuple):
    """Quantity that is measured."""

    name: str
    unit: str = ""  # empty for a pure number

    def format(self, value: float) -> str:
        """Format a value with the unit."""
        if math.isnan(value):
            return "not a number"
        after = f" {self.unit}" if self.unit else ""
        if math.isinf(value):
            return f"infinite{after}"
        if value == 0.0 or 1e-3 <= abs(value) < 1e5:
            return f"{float(f'{value:.3g}'):g}{after}".replace("-", "−")
        mantissa, exponent = f"{value:.1e}".split("e")
        return f"{mantissa} × 10{str(int(exponent)).translate(SUPERSCRIPTS)}{after}"


class Approach(NamedTuple):
    """Method of a case with its bound, which the failing method exceeds and the right one keeps."""

    does: str  # the method in one sentence
    bound: float


@dataclass(frozen=True)
class StabilityCase:
    """Failure of a common method beside the method that avoids it."""

    name: str  # name of the failure
    trigger: str  # cause of the failure, in one sentence
    quantity: Quantity  # what is measured
    failing: Approach  # common method, and the method of this program
    right: Approach
    measure: Callable[[], Measured]  # runs both methods
    scene: str = ""  # name of the bundled scene of the measurement; empty if there is none


@dataclass(frozen=True)
class StabilityTheme:
    """Cases about one subject."""

    title: str  # heading on the page
    place: int  # place on the page; themes stand in the order of these numbers
    cases: list[StabilityCase] = field(default_factory=list)  # cases in order

    def case(
        self, name: str, trigger: str, quantity: Quantity, *, failing: Approach, right: Approach, scene: str = ""
    ) -> Callable[[Callable[[], Measured]], StabilityCase]:
        """Make a case of a function that measures it, and add it to the theme."""

        def add(measure: Callable[[], Measured]) -> StabilityCase:
            case = StabilityCase(name, trigger, quantity, failing, right, cache(measure), scene)
            self.cases.append(case)
            return case

        return add


class Outcome(NamedTuple):
    """Measured errors of a case."""

    case: StabilityCase
    measured: Measured

    @property
    def is_shown(self) -> bool:
        """Whether the failing method exceeds its bound or gives no number."""
        return not self.measured.failing <= self.case.failing.bound

    @property
    def is_held(self) -> bool:
        """Whether the right method keeps its bound."""
        return self.measured.right <= self.case.right.bound

    @property
    def holds(self) -> bool:
        """Whether the failure is shown, and the right method keeps its bound."""
        return self.is_held and self.is_shown

    @property
    def verdict(self) -> str:
        """Verdict in a few words."""
        if not self.is_held:
            return "does not hold"
        return "holds" if self.is_shown else "holds, failure not shown"


def percent(mask: Any) -> float:
    """Percentage of true values."""
    return float(100.0 * np.mean(mask))
