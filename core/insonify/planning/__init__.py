"""Plan of a simulation: the cheapest model of a scene that keeps a tolerance, with reasons."""

from insonify.planning.fitted_laws import MOST_PLANES
from insonify.planning.overrides import METHODS
from insonify.planning.plan_entries import Plan, PlanEntry
from insonify.planning.selection import plan

__all__ = ["METHODS", "MOST_PLANES", "Plan", "PlanEntry", "plan"]
