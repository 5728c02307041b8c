"""Selection of the cheapest model of a scene that keeps a tolerance."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import takewhile
from typing import NamedTuple

from insonify.planning import fitted_laws
from insonify.planning.candidates import Candidate, predict_cost
from insonify.planning.checks import check_method, check_refraction
from insonify.planning.overrides import METHODS, Overrides
from insonify.planning.plan_entries import Plan
from insonify.planning.plane_count import count_rays
from insonify.planning.predicted_errors import PredictedErrors
from insonify.planning.report import ChosenModel, describe_model
from insonify.planning.scene_summary import SceneSummary, summarise_scene
from insonify.scene import Scene, SceneError
from insonify.scene.surfaces import WAYS

FEWEST_CELLS = 8  # that a thinned period of the bed keeps
THINNED = (1, 2, 4, 8, 16, 32)
AT_ONCE = 64e6  # bytes of a block with all its copies
COPIES, MOST_AT_ONCE = 8, 64


class PlanRequest(NamedTuple):
    """Tolerance, method and forced choices of a requested plan."""

    tolerance: float
    asked: str  # requested method
    forced: Overrides


def plan(
    scene: Scene, tolerance: float = 0.03, *, method: str = "auto", forced: Mapping[str, str] | None = None
) -> Plan:
    """Choose the cheapest model of a scene whose predicted error keeps to a tolerance.

    Parameters
    ----------
    scene : Scene
        What to simulate.
    tolerance : float
        Greatest error beyond 1.4 times the altitude, as a share of the record (0.03 is 3 %).
    method : str
        A tracer's name, or "auto".
    forced : mapping of str to str, optional
        Choices that are not left to the plan, by the subjects of its entries: {"planes": "16", "bending": "off"}.
        A choice on a subject for which the scene has no alternatives has no effect.

    Returns
    -------
    Plan
        The cheapest model whose predicted error, with a margin, keeps to the tolerance; the most accurate if none
        does. A greater tolerance therefore never costs more.

    Raises
    ------
    SceneError
        If the tolerance is not a positive number, or the method or a forced choice is unknown or cannot be simulated.
    """
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"tolerance: {tolerance!r} is not above 0; give a share such as 0.03")
    if method not in METHODS:
        raise SceneError(f"method: {method!r} is not known; choose one of {', '.join(METHODS)}")
    wishes = Overrides(forced or {})
    budget = PlanRequest(tolerance, wishes.method() if method == "auto" else method, wishes)
    check_method(scene, budget.asked, 0 if wishes.switch("bounces") is False else scene.sonar.bounces)
    view = summarise_scene(scene)
    errors = PredictedErrors(scene, view, frozenset(way for way in WAYS if wishes.switch(way) is False))
    draft = _cheapest(scene, view, errors, budget)
    if draft.bent:
        check_refraction(scene, budget.asked)
    entries, error = describe_model(ChosenModel(scene, view, draft, errors, budget.asked, wishes))
    return Plan(
        method=draft.method,
        settings=draft.settings(),
        bent=draft.bent,
        every=draft.every,
        bounces=draft.bounces,
        ways=draft.ways,
        targets=draft.targets,
        block=_block(view),
        entries=entries,
        error=error,
        cost=predict_cost(view, draft),
    )


def _cheapest(scene: Scene, view: SceneSummary, errors: PredictedErrors, budget: PlanRequest) -> Candidate:
    """Return the cheapest candidate that keeps to the tolerance, or the most accurate if none does."""
    drafts = [
        _fine_enough(scene, view, errors, budget, Candidate("", every=every, bent=bent, bounces=bounces, ways=ways))
        for bounces in _bounces(scene, budget)
        for bent in _bent(errors, budget)
        for ways in _ways(errors, budget)
        for every in _every(scene, errors, budget, ways)
    ]
    judged = [(errors.wary(draft), predict_cost(view, draft), -draft.every, draft) for draft in drafts]
    kept = [row[1:] for row in judged if row[0] <= budget.tolerance]
    return min(kept)[-1] if kept else min(judged)[-1]


def _fine_enough(
    scene: Scene, view: SceneSummary, errors: PredictedErrors, budget: PlanRequest, draft: Candidate
) -> Candidate:
    """Complete a candidate with its tracer and the planes or rays that the rest of the tolerance requires."""
    forced = budget.forced
    draft = draft._replace(method=_method(scene, budget.asked, draft), targets=_targets(errors, forced))
    rays = int(forced.number("rays") or count_rays(scene, budget.tolerance))
    if draft.method == "march":
        step = forced.number("step") or view.spacing * min(1.0, budget.tolerance / 0.03)
        return draft._replace(step=step, rays=int(forced.number("rays") or view.bins))
    if draft.method == "rays":
        return draft._replace(rays=rays)
    if not scene.sonar.beam.has_width:
        planes = 1
    else:
        rest = math.sqrt(max(budget.tolerance**2 - errors.wary(draft._replace(method="", every=1)) ** 2, 0.0))
        of_nodes = fitted_laws.MARGIN_OF_NODES * errors.thinned(draft.every, draft.ways)
        planes = int(forced.number("planes") or errors.planes(draft.ways).fewest(rest, of_nodes))
    return draft._replace(planes=planes, rays=rays if draft.bent else 0)


def _targets(errors: PredictedErrors, forced: Overrides) -> tuple[int, ...]:
    """Return the indices of the targets to model: those in reach unless forced otherwise."""
    near = errors.targets if _wanted(forced.switch("targets"), True) else ()
    far = errors.far_targets if _wanted(forced.switch("far_targets"), False) else ()
    return tuple(sorted((*near, *far)))


def _ways(errors: PredictedErrors, budget: PlanRequest) -> tuple[frozenset[str], ...]:
    """Return the sets of multipaths to consider: all that arrive within the range, and those without the faintest."""
    forced = budget.forced
    heard = frozenset(way for way in errors.ways if _wanted(forced.switch(way), way in errors.heard))
    free = [way for way in heard if forced.switch(way) is None and way != "surface_echo"]
    faint = sorted((errors.ghosts.shares[way], way) for way in free)
    last = [n + 1 for n, (share, _) in enumerate(faint) if share <= budget.tolerance]
    fewer = [frozenset(way for _, way in faint[:n]) for n in last]
    return (heard, *(heard - some for some in fewer))


def _wanted(forced: bool | None, otherwise: bool) -> bool:
    return otherwise if forced is None else forced


def _method(scene: Scene, asked: str, draft: Candidate) -> str:
    """Name of the tracer: the requested one, otherwise the sweep wherever it can be used."""
    if asked != "auto":
        return asked
    return "rays" if draft.bounces > 0 or (draft.bent and scene.water.varies_along) else "sweep"


def _bounces(scene: Scene, budget: PlanRequest) -> tuple[int, ...]:
    """Numbers of bounces to consider."""
    asked, wish = scene.sonar.bounces, budget.forced.switch("bounces")
    if asked == 0 or wish is not None:
        return (asked if wish else 0,)
    return (asked,) if budget.asked in ("sweep", "march") else (asked, 0)


def _bent(errors: PredictedErrors, budget: PlanRequest) -> tuple[bool, ...]:
    """Alternatives to consider for refraction: refracted rays, straight rays or both."""
    wish = budget.forced.switch("bending")
    if errors.bending.most == 0.0:
        return (False,)
    return (True, False) if wish is None else (wish,)


def _every(scene: Scene, errors: PredictedErrors, budget: PlanRequest, ways: frozenset[str]) -> tuple[int, ...]:
    """Strides of the nodes of the relief to consider, as far as the tolerance allows."""
    seabed, wish = scene.seabed, budget.forced.number("spacing")
    cells = {round(part.period / seabed.spacing) for part in seabed.random_reliefs if not part.endless}
    if wish is not None:
        every = int(wish)
        if any(count % every for count in cells):
            raise SceneError(
                f"model spacing: '{every}' does not divide the {min(cells)} cells after which the bed repeats; "
                "give a number that does, such as 1"
            )
        return (every,)
    if not (seabed.random_reliefs or seabed.relief.level):
        return (1,)
    fitting = (n for n in THINNED if n == 1 or all(count % n == 0 and count >= FEWEST_CELLS * n for count in cells))
    if not seabed.relief.level:
        return tuple(takewhile(lambda n: errors.thinned(n, ways).min() <= budget.tolerance, fitting))
    peak = fitted_laws.LEVEL_PEAK * (seabed.spacing / scene.altitude) ** 2 / (fitted_laws.PEAK_SEEN * budget.tolerance)
    most = min(budget.tolerance, fitted_laws.LEVEL_SEEN)
    return tuple(n for n in fitting if n == 1 or (n * n * peak <= 1.0 and errors.thinned(n, ways).min() <= most))


def _block(view: SceneSummary) -> int:
    """Return the number of pings per block that fits into the memory set aside for a block."""
    fitting = AT_ONCE / (COPIES * 2 * 4 * view.bins)
    return int(min(max(fitting, 1.0), MOST_AT_ONCE))
