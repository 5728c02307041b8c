"""Plan of a simulation: the cheapest model of a scene whose measured error keeps a tolerance, with reasons."""

from insonify.planning.choices.fineness import METHODS, MOST_PLANES
from insonify.planning.plan_entries import Plan, PlanEntry
from insonify.planning.selection import plan

__all__ = ["METHODS", "MOST_PLANES", "Plan", "PlanEntry", "plan"]
