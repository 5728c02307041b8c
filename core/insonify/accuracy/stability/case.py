"""Stability case: an input on which a common method fails, beside the method that this program uses."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from insonify.accuracy.stability.drawing import Picture

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Measured(NamedTuple):
    """Errors of both methods of a case, in its unit; NaN where a method gives no number."""

    failing: float
    right: float
    picture: Picture

    @classmethod
    def by(cls, error: Callable[[Any], Any], failing: object, right: object, picture: Picture) -> Measured:
        """Measure the results of both methods by the same error."""
        return cls(float(error(failing)), float(error(right)), picture)


@dataclass(frozen=True)
class StabilityCase:
    """Failure of a common method beside the method that avoids it, each in one sentence and with its bound."""

    name: str  # name of the failure
    trigger: str  # cause of the failure, in one sentence
    quantity: str  # what is measured
    unit: str  # empty for a pure number
    failing: str  # common method
    exceeded: float  # value above which it has failed
    right: str  # method of this program
    kept: float  # greatest value of a method that has not
    measure: Callable[[], Measured]  # runs both methods
    scene: str = ""  # name of the bundled scene of the measurement; empty if there is none

    def format(self, value: float) -> str:
        """Format a value of the quantity with its unit."""
        if math.isnan(value):
            return "not a number"
        after = f" {self.unit}" if self.unit else ""
        if math.isinf(value):
            return f"infinite{after}"
        if value == 0.0 or 1e-3 <= abs(value) < 1e5:
            return f"{float(f'{value:.3g}'):g}{after}".replace("-", "−")
        mantissa, exponent = f"{value:.1e}".split("e")
        return f"{mantissa} × 10{str(int(exponent)).translate(SUPERSCRIPTS)}{after}"


@dataclass(frozen=True)
class StabilityTheme:
    """Cases about one subject."""

    title: str  # heading on the page
    place: int  # place on the page; themes stand in the order of these numbers
    cases: list[StabilityCase] = field(default_factory=list)  # cases in order

    def case(self, *row: Any, scene: str = "") -> Callable[[Callable[[], Measured]], StabilityCase]:
        """Make a case of the first fields of `StabilityCase` and of a function that measures, and add it."""

        def add(measure: Callable[[], Measured]) -> StabilityCase:
            case = StabilityCase(*(*row, cache(measure), scene))
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
        return not self.measured.failing <= self.case.exceeded

    @property
    def is_held(self) -> bool:
        """Whether the right method keeps its bound."""
        return self.measured.right <= self.case.kept

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


def worst(values: Any, exact: Any) -> float:
    """Greatest deviation from exact values, in per cent."""
    return float(100.0 * np.abs(np.asarray(values) / exact - 1.0).max())
