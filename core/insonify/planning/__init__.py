"""Choose, for a scene and a tolerance, the cheapest model that is accurate enough, and say why."""

from insonify.planning.choose import plan
from insonify.planning.entries import Entry, Plan
from insonify.planning.laws import MOST_PLANES
from insonify.planning.overrides import METHODS

__all__ = ["METHODS", "MOST_PLANES", "Entry", "Plan", "plan"]
