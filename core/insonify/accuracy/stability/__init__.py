"""Where methods of this kind fail, and what this project does instead: every failure beside its remedy, measured."""

from insonify.accuracy.stability.case import Case, Outcome, Way, judge
from insonify.accuracy.stability.cases import CASES

__all__ = ["CASES", "Case", "Outcome", "Way", "judge"]
