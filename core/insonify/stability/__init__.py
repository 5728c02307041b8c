"""Where methods of this kind fail, and what this project does instead: every failure beside its remedy, measured."""

from insonify.stability.case import Case, Outcome, Way, judge
from insonify.stability.cases import CASES

__all__ = ["CASES", "Case", "Outcome", "Way", "judge"]
