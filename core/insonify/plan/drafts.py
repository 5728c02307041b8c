"""Ways to model a scene, what each costs, and the settings of its tracer."""

from __future__ import annotations

from typing import Any, NamedTuple

from insonify.plan import laws
from insonify.plan.view import View


class Draft(NamedTuple):
    """One way to model a scene."""

    method: str
    planes: int = 1
    rays: int = 0  # per side; of a sweep, of the pings whose sound folds
    step: float = 0.0  # m, of a march
    every: int = 1  # of so many nodes of the relief one is kept
    bent: bool = False
    bounces: int = 0
    targets: tuple[int, ...] = ()  # modelled
    ways: frozenset[str] = frozenset()  # by the sea surface

    def settings(self) -> dict[str, Any]:
        """Return what the tracer is called with."""
        if self.method == "march":
            return {"step": self.step, "rays": self.rays}
        if self.method == "rays":
            return {"rays": self.rays}
        return {"planes": self.planes} | ({"rays": self.rays} if self.bent else {})


def cost(view: View, draft: Draft) -> float:
    """Predict what a ping costs, both sides on one thread, in seconds of the machine of the laws."""
    base = laws.A_PING + 2.0 * view.bins * laws.A_BIN
    per_way = 1.0 + laws.A_WAY * len(draft.ways)
    if draft.method != "sweep":
        steps = view.reach / draft.step * laws.A_STEP if draft.method == "march" else 0.0
        bent = laws.BENT_RAYS if draft.bent else 1.0
        per_ray = (laws.A_RAY + steps) * bent * (1.0 + laws.A_BOUNCE * draft.bounces)
        return base + 2.0 * draft.rays * per_ray * per_way
    knots = 2.0 * view.ground / (view.spacing * draft.every)
    bent = laws.BENT if draft.bent else 1.0
    plane = laws.A_PLANE + knots * laws.A_KNOT * bent + len(draft.targets) * laws.A_TARGET
    planes = draft.planes if draft.planes == 1 else draft.planes + laws.NEAR_PLANES
    return base + planes * plane * per_way
