"""From a scene and a tolerance to the cheapest model that keeps to it."""

from __future__ import annotations

import math
from collections.abc import Mapping

from insonify.plan.across import demand_of, planes_for, rays_for
from insonify.plan.drafts import Draft, cost
from insonify.plan.entries import Plan
from insonify.plan.forcing import METHODS, Forced
from insonify.plan.refusals import refuse, refuse_bent
from insonify.plan.telling import Told, entries_of
from insonify.plan.view import View, look_at
from insonify.scene import Scene, SceneError
from insonify.scene.sonar import Knife
from insonify.scene.surface import WAYS
from insonify.scene.water import SectionWater
from insonify.sound.straightness import Bending, bending_of


def plan(
    scene: Scene, tolerance: float = 0.03, *, method: str = "auto", forced: Mapping[str, str] | None = None
) -> Plan:
    """Plan a simulation.

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
        One about which the scene leaves no choice is without effect.

    Returns
    -------
    Plan

    Raises
    ------
    SceneError
        If the tolerance is not a positive number, or the method or what is forced is unknown or cannot be done.
    """
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"tolerance: {tolerance!r} is not above 0; give a share such as 0.03")
    if method not in METHODS:
        raise SceneError(f"method: {method!r} is not known; choose one of {', '.join(METHODS)}")
    wishes = Forced(forced or {})
    asked = wishes.method() if method == "auto" else method
    bounces = 0 if wishes.switch("bounces") is False else scene.sonar.bounces
    refuse(scene, asked, bounces)
    view, bending = look_at(scene), bending_of(scene)
    draft = _draft(scene, view, tolerance, asked, bending, wishes, bounces)
    told = Told(scene, view, draft, bending, asked, wishes)
    entries, error = entries_of(told)
    return Plan(
        method=draft.method,
        settings=draft.settings(),
        bent=draft.bent,
        every=draft.every,
        bounces=draft.bounces,
        ways=draft.ways,
        targets=tuple(range(draft.targets)),
        entries=entries,
        error=error,
        cost=cost(view, draft),
    )


def _draft(
    scene: Scene, view: View, tolerance: float, asked: str, bending: Bending, wishes: Forced, bounces: int
) -> Draft:
    """Choose how to model a scene."""
    bent = bending.most >= tolerance if (switch := wishes.switch("bending")) is None else switch
    bent = bent and bending.most > 0.0
    if bent:
        refuse_bent(scene, asked)
    surface = scene.water.surface
    draft = Draft(
        method=_method(scene, asked, bent, bounces),
        bent=bent,
        bounces=bounces,
        every=int(wishes.number("spacing") or 1),
        targets=0 if wishes.switch("targets") is False else len(scene.targets),
        ways=frozenset(way for way in WAYS if getattr(surface, way, False) and wishes.switch(way) is not False),
    )
    rays = int(wishes.number("rays") or rays_for(scene, tolerance))
    if draft.method == "march":
        step = wishes.number("step") or view.spacing * min(1.0, tolerance / 0.03)
        return draft._replace(step=step, rays=int(wishes.number("rays") or view.bins))
    if draft.method == "rays":
        return draft._replace(rays=rays)
    knife = isinstance(scene.sonar.beam, Knife)
    planes = int(wishes.number("planes") or planes_for(demand_of(scene, view), tolerance, knife=knife))
    return draft._replace(planes=1 if knife else planes, rays=rays if bent else 0)


def _method(scene: Scene, asked: str, bent: bool, bounces: int) -> str:
    """Pick the tracer."""
    if asked != "auto":
        return asked
    return "rays" if bounces > 0 or (bent and isinstance(scene.water, SectionWater)) else "sweep"
