"""Where methods of this kind fail, and what this project does instead: every failure beside its remedy, measured."""

from insonify.accuracy.stability.case import Approach, Outcome, StabilityCase, measure_case
from insonify.accuracy.stability.cases import CASES

__all__ = ["CASES", "Approach", "Outcome", "StabilityCase", "measure_case"]
