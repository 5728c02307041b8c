"""Cases of numerical failure of common methods, each measured beside the method that avoids it."""

from insonify.accuracy.stability.case import Approach, Outcome, StabilityCase, measure_case
from insonify.accuracy.stability.cases import CASES

__all__ = ["CASES", "Approach", "Outcome", "StabilityCase", "measure_case"]
