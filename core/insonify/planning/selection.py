"""Selection of the cheapest model of a scene with a measured error within the tolerance."""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import takewhile

from insonify.packing.packed_scene import Model, PackedScene, pack
from insonify.planning.choices import CHOICES
from insonify.planning.choices.base import FINENESS, GRID, Case, Choice
from insonify.planning.choices.fineness import Planes
from insonify.planning.plan_entries import Plan
from insonify.scene import Scene, SceneError
from insonify.tracers.base import AUTO, find_tracer
from insonify.tracers.plane_counts import MOST_PLANES, Goal

# Shares of the tolerance: of refraction, of paths by the surface, of segments and of nodes if they are left out, and of
# planes or rays. Their squares add up to one.
OF_A_CHOICE = 1.0 / 6.0
OF_PLANES = math.sqrt(1.0 - 4.0 * OF_A_CHOICE**2)
STAGED = sorted(CHOICES, key=lambda choice: choice.stage)
FINE = [choice for choice in STAGED if choice.stage == FINENESS]
PLANES = next(choice for choice in CHOICES if isinstance(choice, Planes))
BY_SUBJECT = {choice.subject: choice for choice in CHOICES if choice.offered}


def plan(
    scene: Scene, tolerance: float = 0.03, *, method: str = "auto", forced: Mapping[str, str] | None = None
) -> Plan:
    """Choose the cheapest model of a scene with a measured error within the tolerance.

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
        A choice on a subject for which the scene has no alternatives has no effect. Errors of forced choices are
        reported, and do not count against the tolerance.

    Returns
    -------
    Plan
        The cheapest model with an error, measured on a few pings, that is within the tolerance by a margin; the most
        accurate if none is. A greater tolerance therefore never costs more.

    Raises
    ------
    SceneError
        If the tolerance is not a positive number, the method or a forced choice is unknown or cannot be simulated, or
        the scene cannot be built.
    """
    check_request(scene, tolerance, method, forced or {})
    return choose_model(pack(scene), tolerance, method, forced or {})


def check_request(scene: Scene, tolerance: float, method: str, forced: Mapping[str, str]) -> None:
    """Raise an error if a plan cannot be made, before the scene is built."""
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise SceneError(f"tolerance: {tolerance!r} is not above 0; give a share such as 0.03")
    if method != AUTO:
        find_tracer(method)
    for subject, text in forced.items():
        if subject not in BY_SUBJECT:
            raise SceneError(f"model: {subject!r} is not a choice of a plan; choose one of {', '.join(BY_SUBJECT)}")
        BY_SUBJECT[subject].parse(text)
    _check_method(scene, _requested(method, forced), 0 if forced.get("bounces") == "off" else scene.sonar.bounces)


def _check_method(scene: Scene, method: str, bounces: int) -> None:
    """Raise an error if a method cannot simulate what the scene declares."""
    tracer = None if method == AUTO else find_tracer(method)
    surface = scene.water.surface
    if bounces > 0 and tracer is not None and not tracer.follows_bounces:
        raise SceneError(f"sonar.bounces: {method!r} does not follow bounces, here {bounces}; set it to 0 or use rays")
    if scene.receiver.speckle.interferes:
        if bounces > 0 or (tracer is not None and not tracer.sums_waves):
            other = f"bounces (sonar.bounces is {bounces})" if bounces > 0 else f"the method {method!r}"
            raise SceneError(f"receiver.speckle: 'coherent' is part of the sweep, not of {other}; take another speckle")
        if surface.reflects:
            raise SceneError(
                f"water.surface: {surface.kind!r} adds multipath, which 'coherent' speckle does not include; take "
                "another receiver.speckle, or the surface 'none'"
            )
    if tracer is not None:
        tracer.refuse(scene)


def choose_model(packed: PackedScene, tolerance: float, method: str, forced: Mapping[str, str]) -> Plan:
    """Choose the model of a packed scene, with the parameters of `plan`."""
    return choose_for_case(Case(packed, _requested(method, forced), forced), tolerance)


def choose_for_case(case: Case, tolerance: float) -> Plan:
    """Choose the model of a case for a tolerance; what was measured for another tolerance is not measured again."""
    model = _cheapest(case, tolerance)
    cost = case.seconds(model)  # first, so that costs of other models are estimated from this one
    entries = [
        entry for choice in CHOICES for entry in choice.entries(case, model, choice.error(case, model, cautious=False))
    ]
    # The costs of what is modelled multiply one another; scaled, they add up to that of a ping.
    apart = sum(entry.cost for entry in entries if entry.modelled)
    share = cost / apart if apart > 0.0 else 1.0
    entries = [replace(entry, cost=share * entry.cost) if entry.modelled else entry for entry in entries]
    # A single plane is not measured ping by ping.
    goal = _find_goal(case, model, tolerance)
    if goal is not None and model.planes > 1:  # pings of a greater error have more planes
        least = max(goal.tolerance, PLANES.law(case, model).of(MOST_PLANES))
        entries = [
            replace(each, error=min(each.error, least)) if each.subject == PLANES.subject else each for each in entries
        ]
    left_out = math.hypot(*(entry.error for entry in entries if entry.subject != PLANES.subject or model.planes == 1))
    error = math.hypot(*(entry.error for entry in entries))
    return Plan(model, tuple(entries), error, left_out, goal, case.work(model), cost)


def _find_goal(case: Case, model: Model, tolerance: float) -> Goal | None:
    """Error of its planes with which the tracing of a ping ends; none where their number is forced or of no account."""
    if PLANES.wish(case) is not None or not (PLANES.applies(model) and case.scene.sonar.beam.has_width):
        return None
    if model.planes == 1 and model.across == 0:  # else pings that meet a target have several
        return None
    trust = PLANES.law(case, model).trust
    # Over a level bed, which errs by nothing, the pings measured are the few that meet targets: no reason for less.
    return Goal(OF_PLANES * tolerance, trust if model.planes > 1 else max(trust, 1.0))


def keep_plan(packed: PackedScene, last: Plan, method: str, forced: Mapping[str, str]) -> Plan:
    """Keep the plan of a similar scene where the geometry of this one admits it, without measuring anything."""
    case, model = Case(packed, _requested(method, forced), forced), Model()
    for choice in STAGED:
        model = model._replace(**{choice.field: choice.kept(case, model, last.model)})
        choice.require(case, model)
    return last if model == last.model else Plan(model, goal=last.goal)


def _requested(method: str, forced: Mapping[str, str]) -> str:
    return forced.get("method", AUTO) if method == AUTO else method


def _cheapest(case: Case, tolerance: float) -> Model:
    """Model of the least work among the settings of each choice with an error within its share of the tolerance."""
    # Shares are fixed, so that more tolerance never means more work, and errors of unlike kinds add up by squares.
    model = Model()
    for choice in STAGED:
        if choice.stage == GRID:  # of which the work depends on the fineness
            model = model._replace(**{fine.field: fine.settings(case, model)[0] for fine in FINE})
        most = (OF_PLANES if choice.stage == FINENESS else OF_A_CHOICE) * tolerance
        model = _choose(case, choice, model, most, tolerance)
        choice.require(case, model)
    return model


def _choose(case: Case, choice: Choice, model: Model, most: float, tolerance: float) -> Model:
    """Model with the setting of one choice."""
    values = choice.settings(case, model)
    if choice is PLANES and len(values) > 1:
        if values[0] == 1 and PLANES.single_error(case, model) <= most:
            return model._replace(planes=1)
        counts = [count for count in values if count > 1]
        return model._replace(planes=PLANES.law(case, model).enough(counts, most))
    *coarser, finest = (model._replace(**{choice.field: value}) for value in values)
    if choice.stage == GRID:  # coarser nodes make longer segments, which may take more work
        enough = takewhile(lambda one: choice.error(case, one) <= most, reversed(coarser))
        return min((*reversed([*enough]), finest), key=case.work)
    if coarser and not _is_able(case, choice, finest):
        most = tolerance
    able = (one for one in coarser if _is_able(case, choice, one) and choice.error(case, one) <= most)
    return next(able, finest)


def _is_able(case: Case, choice: Choice, model: Model) -> bool:
    try:
        choice.require(case, model)
    except SceneError:
        return False
    return True
