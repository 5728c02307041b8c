"""Choose, for a scene and a tolerance, the cheapest model that is accurate enough, and say why."""

from insonify.plan.choose import plan
from insonify.plan.entries import Entry, Plan
from insonify.plan.forcing import METHODS
from insonify.plan.laws import MOST_PLANES

__all__ = ["METHODS", "MOST_PLANES", "Entry", "Plan", "plan"]
