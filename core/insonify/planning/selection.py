"""Selection of the cheapest model of a scene with a measured error within the tolerance."""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import takewhile
from typing import NamedTuple

from insonify.packing.packed_scene import Model, PackedScene, pack
from insonify.planning.case import Case
from insonify.planning.effects import BY_SUBJECT, OF_PLANES, ROWS, Effect, plane_law, planes_error, remark
from insonify.planning.plan_entries import Plan, PlanEntry
from insonify.scene import Scene, SceneError
from insonify.tracers.base import AUTO, find_tracer
from insonify.tracers.plane_counts import MOST_PLANES, Goal, Trust

# Order of choice: effects, the tracer, its fineness, the bed. The last, because its work depends on all others.
EFFECTS = ("bounces", "targets", "far_targets", "bending", *(row.subject for row in ROWS if row.field == "ways"))
FINENESS = ("target_planes", "planes", "rays", "step", "fineness")
STAGED = [BY_SUBJECT[subject] for subject in (*EFFECTS, "method", *FINENESS, "segments", "spacing")]


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
    return choose_for_case(make_case(packed, method, forced), tolerance)


def make_case(packed: PackedScene, method: str, forced: Mapping[str, str]) -> Case:
    """Case of a packed scene, with the parameters of `plan`."""
    return Case(packed, _requested(method, forced), forced)


def choose_for_case(case: Case, tolerance: float) -> Plan:
    """Choose the model of a case for a tolerance; what was measured for another tolerance is not measured again."""
    model = _cheapest(case, tolerance)
    goal = _find_goal(case, model, tolerance)
    entries = [entry for row in ROWS for entry in _describe(case, row, model, tolerance)]
    entries += remark(case, model)
    # The costs of what is modelled multiply one another; scaled, they add up to that of a ping.
    cost = case.seconds(model) + case.seconds_of_waves(model)
    apart = sum(entry.cost for entry in entries if entry.modelled)
    share = cost / apart if apart > 0.0 else 1.0
    entries = [replace(entry, cost=share * entry.cost) if entry.modelled else entry for entry in entries]
    if goal is not None and model.planes > 1:  # pings of a greater error have more planes
        least = max(goal.tolerance, plane_law(case, model.across, model.planes).of(MOST_PLANES))
        entries = [
            replace(each, error=min(each.error, least)) if each.subject == "planes" else each for each in entries
        ]
    # A single plane is not measured ping by ping.
    left_out = math.hypot(*(entry.error for entry in entries if entry.subject != "planes" or model.planes == 1))
    error = math.hypot(*(entry.error for entry in entries))
    return Plan(model, tuple(entries), error, left_out, goal, case.work(model), cost)


def _describe(case: Case, row: Effect, model: Model, tolerance: float) -> list[PlanEntry]:
    """Entry of a row, if it concerns the scene, with the time that its effect takes or would take."""
    error = row.judge(case, model, tolerance)
    said = row.say(case, model, error)
    if said is None:
        return []
    cost = 0.0
    if row.subject == "method":  # in its simplest use
        cost = case.seconds(Model(model.method, rays=model.rays, step=model.step, fineness=model.fineness))
    elif said.without is not None:
        saved = case.seconds(model) - case.seconds(said.without)
        cost = max(saved if said.modelled else -saved, 0.0)
    options = row.offered if said.options is None else said.options
    forced = row.subject in case.forced
    return [PlanEntry(row.subject, said.choice, said.reason, said.modelled, error, cost, options, forced)]


def _find_goal(case: Case, model: Model, tolerance: float) -> Goal | None:
    """Error of its planes with which the tracing of a ping ends; none where their number is forced or of no account."""
    swept = "planes" in find_tracer(model.method).fineness and case.scene.sonar.beam.has_width
    if "planes" in case.forced or not swept:
        return None
    if model.planes == 1 and model.across == 0:  # else pings that meet a target have several
        return None
    trust = plane_law(case, model.across, model.planes).trust
    # Over a level bed, which errs by nothing, the pings measured are the few that meet targets: no reason for less.
    trust = trust if model.planes > 1 else Trust(*(max(each, 1.0) for each in trust))
    return Goal(OF_PLANES * tolerance, trust)


def keep_plan(packed: PackedScene, last: Plan, method: str, forced: Mapping[str, str]) -> Plan:
    """Keep the plan of a similar scene where the geometry of this one admits it, without measuring anything."""
    case, model = make_case(packed, method, forced), Model()
    for row in STAGED:
        values, value = row.values(case, model), getattr(last.model, row.field)
        if row.field == "ways":  # each row sets one of them
            value = model.ways | (value & {row.subject})
        model = model._replace(**{row.field: value if value in values else values[-1]})
        _require(case, row, model)
    return last if model == last.model else Plan(model, goal=last.goal)


class Alternative(NamedTuple):
    """The next coarser setting of one row of a plan, which is not taken."""

    subject: str
    words: str
    error: float  # of the setting; of planes that of three quarters of the pings
    allowed: float  # its share of the tolerance
    work: float  # of a ping, over that of the plan


def list_alternatives(case: Case, made: Plan, tolerance: float) -> list[Alternative]:
    """List the next coarser setting of each row of a plan that could be coarser."""
    found, model = [], made.model
    for row in ROWS:
        values, value = row.values(case, model), getattr(model, row.field)
        place = values.index(value) if value in values else 0
        if place == 0 or row.subject in case.forced:
            continue
        coarser = model._replace(**{row.field: values[place - 1]})
        is_planes = row.subject == "planes" and coarser.planes > 1
        law = plane_law(case, model.across, coarser.planes) if is_planes else None
        error = row.judge(case, coarser, tolerance) if law is None else law.usual(coarser.planes)
        said = row.say(case, coarser, error)
        if said is not None:
            words = f"{said.choice} to begin with" if is_planes else said.choice
            words = words if said.modelled else f"without {words}"
            share = case.work(coarser) / made.work
            found.append(Alternative(row.subject, words, error, row.share * tolerance, share))
    return found


def _requested(method: str, forced: Mapping[str, str]) -> str:
    return forced.get("method", AUTO) if method == AUTO else method


def _cheapest(case: Case, tolerance: float) -> Model:
    """Model of the least work among the settings of each row with an error within its share of the tolerance."""
    scene, model = case.scene, Model()
    whole = Model(bent=case.bent, bounces=0 if "bounces" in case.forced else scene.sonar.bounces)
    if case.requested in (AUTO, model.method) and case.choose_tracer(whole) == model.method:
        open_rows = (row for row in ROWS if row.closed(case, model)[1] > row.share * tolerance)
        if models := [each for row in open_rows for each in row.probes(case)]:
            case.probe.trace(models)
    for row in STAGED:
        model = _choose(case, row, model, tolerance)
        _require(case, row, model)
    return model


def _choose(case: Case, row: Effect, model: Model, tolerance: float) -> Model:
    """Model with the setting of one row."""
    values, most = row.values(case, model), row.share * tolerance
    *coarser, finest = (model._replace(**{row.field: value}) for value in values)
    if row.subject == "spacing":  # coarser nodes make longer segments, which may take more work
        enough = takewhile(lambda one: row.judge(case, one, tolerance) <= most, reversed(coarser))
        return min((*reversed([*enough]), finest), key=case.work) if coarser else finest
    if row.subject == "planes" and coarser:
        if values[0] == 1 and planes_error(case, coarser[0]) <= most:
            return coarser[0]
        usual = ((count, plane_law(case, model.across, count).usual(count)) for count in values if count > 1)
        return model._replace(planes=next((count for count, error in usual if error <= most), values[-1]))
    if coarser and not _is_able(case, row, finest):
        most = tolerance
    able = (one for one in coarser if _is_able(case, row, one) and row.judge(case, one, tolerance) <= most)
    return next(able, finest)


def _require(case: Case, row: Effect, model: Model) -> None:
    """Raise a SceneError if a model cannot be simulated: refraction with an effect along straight rays only."""
    if row.subject == "bending" and model.bent:
        case.check_refraction()


def _is_able(case: Case, row: Effect, model: Model) -> bool:
    try:
        _require(case, row, model)
    except SceneError:
        return False
    return True
