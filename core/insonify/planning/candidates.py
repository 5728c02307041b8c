"""Candidate models of a scene: their settings and their predicted cost."""

from __future__ import annotations

from typing import Any, NamedTuple

from insonify.planning import fitted_laws
from insonify.planning.scene_summary import SceneSummary


class Candidate(NamedTuple):
    """Candidate model of a scene: its tracer, the settings of the tracer, and the effects that it includes."""

    method: str
    planes: int = 1
    rays: int = 0  # per side; of the sweep, for pings where several eigenrays or none reach a place
    step: float = 0.0  # m, of the march
    every: int = 1  # stride of the nodes of the relief that are kept
    bent: bool = False
    bounces: int = 0
    targets: tuple[int, ...] = ()  # indices of those modelled
    ways: frozenset[str] = frozenset()  # multipaths by the sea surface that are modelled

    def settings(self) -> dict[str, Any]:
        """Return the keyword arguments of the tracer."""
        if self.method == "march":
            return {"step": self.step, "rays": self.rays}
        if self.method == "rays":
            return {"rays": self.rays}
        return {"planes": self.planes} | ({"rays": self.rays} if self.bent else {})


def predict_cost(view: SceneSummary, draft: Candidate) -> float:
    """Predict the seconds per ping, both sides on one thread, on the machine that the laws were fitted on."""
    return sum(fitted_laws.SECONDS[name] * amount for name, amount in count_operations(view, draft).items())


def count_operations(view: SceneSummary, draft: Candidate) -> dict[str, float]:
    """Count the operations of a ping, by the names in ``fitted_laws.SECONDS``."""
    counts = {"ping": 1.0, "bin": 2.0 * view.bins}
    ways = len(draft.ways)
    if draft.method != "sweep":
        rays = 2.0 * draft.rays * (1.0 + ways) * (1.0 + draft.bounces)
        steps = rays * view.reach / draft.step if draft.method == "march" else 0.0
        return counts | {"bent ray" if draft.bent else "ray": rays, "step": steps}
    planes, knots = _profiles(view, draft, fitted_laws.PROFILES)
    of_ways = _profiles(view, draft, fitted_laws.PROFILES_OF_WAYS)
    met = 2.0 * draft.planes * len(draft.targets)
    return counts | {
        "plane": planes,
        "knot": knots,
        "aslant knot": knots * view.aslant,
        "bent knot": knots if draft.bent else 0.0,
        "target": met,
        "way's plane": of_ways[0] * ways,
        "way's knot": of_ways[1] * ways,
        "way's aslant knot": of_ways[1] * ways * view.aslant,
        "way's target": met * ways,
    }


def _profiles(
    view: SceneSummary, draft: Candidate, as_many: dict[str, tuple[float, float, float]]
) -> tuple[float, float]:
    """Equivalent number of whole profiles in a ping, near field and sidelobes included, and their total of knots."""
    each, few, near = as_many[view.pattern]
    whole = 1.0 if draft.planes == 1 else each * draft.planes + few + near * min(view.altitude / view.reach, 1.0)
    looked_up = fitted_laws.LOOKED_UP if view.pattern in fitted_laws.TABLED else 1.0
    return 2.0 * whole, 2.0 * whole * looked_up * view.ground / (view.spacing * draft.every)
