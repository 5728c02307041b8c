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
    """Method and its measured error.

    Attributes
    ----------
    does : str
        What the method does, as a sentence.
    error : callable
        Measures its error in the case's unit; NaN where the method gives no number.
    bound : float
        Bound that the failing method exceeds and the right one keeps.
    """

    does: str
    error: Callable[[], float]
    bound: float


@dataclass(frozen=True)
class StabilityCase:
    """Failure of a common method beside the method that avoids it.

    Attributes
    ----------
    name : str
        Name of the failure.
    trigger : str
        Cause of the failure, in one sentence.
    figure : str
        Quantity that is measured.
    unit : str
        Unit of that quantity, empty for a pure number.
    failing, right : Way
        Common method, and the method of this program.
    picture : callable
        Draws both on an empty figure.
    scene : str
        Name of the bundled scene of the measurement; empty if there is none.
    """

    name: str
    trigger: str
    figure: str
    unit: str
    failing: Approach
    right: Approach
    picture: Callable[[Figure], None]
    scene: str = ""


@dataclass(frozen=True)
class StabilityTheme:
    """Cases about one subject.

    Attributes
    ----------
    title : str
        Heading on the page.
    place : int
        Place on the page; themes stand in the order of these numbers.
    cases : tuple of StabilityCase
        Cases in order.
    """

    title: str
    place: int
    cases: tuple[StabilityCase, ...]


@dataclass(frozen=True)
class Outcome:
    """Measured errors of a case.

    Attributes
    ----------
    case : Case
    failing, right : float
        Errors of its two methods.
    """

    case: StabilityCase
    failing: float
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
    """Measure both methods of a case.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Outcome
    """
    return Outcome(case, float(case.failing.error()), float(case.right.error()))


def format_quantity(value: float, unit: str) -> str:
    """Format a quantity with its unit.

    Parameters
    ----------
    value : float
    unit : str

    Returns
    -------
    str
        At most three digits, with a power of ten where needed, or "not a number".
    """
    if math.isnan(value):
        return "not a number"
    after = f" {unit}" if unit else ""
    if math.isinf(value):
        return f"infinite{after}"
    if value == 0.0 or 1e-3 <= abs(value) < 1e5:
        return f"{float(f'{value:.3g}'):g}{after}".replace("-", "−")
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa} × 10{str(int(exponent)).translate(RAISED)}{after}"
