"""Choose, for a scene and a tolerance, the cheapest model that is accurate enough, and say why."""

from insonify.planning.fitted_laws import MOST_PLANES
from insonify.planning.overrides import METHODS
from insonify.planning.plan_entries import Plan, PlanEntry
from insonify.planning.selection import plan

__all__ = ["METHODS", "MOST_PLANES", "Plan", "PlanEntry", "plan"]
