"""Plan of a simulation: the cheapest model of a scene with a measured error within the tolerance, and the reasons."""

from insonify.planning.plan_entries import Plan, PlanEntry
from insonify.planning.selection import plan
from insonify.tracers.plane_counts import MOST_PLANES

__all__ = ["MOST_PLANES", "Plan", "PlanEntry", "plan"]
