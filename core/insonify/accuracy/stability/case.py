"""What a case is: something that makes a method fail, the method, and the one that does not."""

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
    """One way to do a thing.

    Attributes
    ----------
    does : str
        What it does, as a sentence.
    error : callable
        Measures how far it is from the truth, in the case's unit; NaN where it gives no number.
    bound : float
        What the failing way exceeds and the right one stays within.
    """

    does: str
    error: Callable[[], float]
    bound: float


@dataclass(frozen=True)
class StabilityCase:
    """A failure beside its remedy.

    Attributes
    ----------
    name : str
        Of what goes wrong.
    trigger : str
        What makes the method fail, in one sentence.
    figure : str
        What is measured.
    unit : str
        Its unit, empty for a pure number.
    failing, right : Way
        The plain method, and what the project does.
    picture : callable
        Draws both on an empty figure.
    scene : str
        Name of the bundled scene that it is measured on; empty if it needs none.
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
class Outcome:
    """What a case came to.

    Attributes
    ----------
    case : Case
    failing, right : float
        Errors of its two ways.
    """

    case: StabilityCase
    failing: float
    right: float

    @property
    def is_shown(self) -> bool:
        """Whether the failing way fails beyond its bound; one that gives no number does."""
        return not self.failing <= self.case.failing.bound

    @property
    def is_held(self) -> bool:
        """Whether the right way stays within its own."""
        return self.right <= self.case.right.bound

    @property
    def verdict(self) -> str:
        """Say it in a word or two."""
        if not self.is_held:
            return "does not hold"
        return "holds" if self.is_shown else "holds, failure not shown"


def measure_case(case: StabilityCase) -> Outcome:
    """Measure both ways of a case.

    Parameters
    ----------
    case : Case

    Returns
    -------
    Outcome
    """
    return Outcome(case, float(case.failing.error()), float(case.right.error()))


def format_quantity(value: float, unit: str) -> str:
    """Write a figure as people read it.

    Parameters
    ----------
    value : float
    unit : str

    Returns
    -------
    str
        Three digits at most, with powers of ten where needed; what is no number is said to be none.
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
