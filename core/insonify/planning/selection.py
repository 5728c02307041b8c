"""Selection of the cheapest model of a scene with a measured error within the tolerance."""

import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from heapq import heappop, heappush
from itertools import takewhile
from typing import Any

from insonify.packing.packed_scene import Model, PackedScene, pack
from insonify.planning.choices import CHOICES
from insonify.planning.choices.base import FINENESS, Case, Choice
from insonify.planning.choices.fineness import Planes, measure_together
from insonify.planning.plan_entries import Plan, PlanEntry, percent
from insonify.scene import Scene, SceneError
from insonify.tracers.base import AUTO, find_tracer

# Pings other than those probed may err more than these vary: measured over random scenes, see docs/theory/error.md.
SAFETY = 1.25
MORE_TOGETHER = 1.2  # times the sum of the errors, beyond which a plan reports the joint error
STAGED = sorted(CHOICES, key=lambda choice: choice.stage)
COARSE = [choice for choice in STAGED if choice.stage < FINENESS]
FINE = [choice for choice in STAGED if choice.stage == FINENESS]
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
    model = _cheapest(case, tolerance / SAFETY)
    cost = case.seconds(model)  # first, so that costs of other models are estimated from this one
    entries = tuple(
        entry
        for choice in CHOICES
        for entry in choice.entries(case, model, choice.confirmed(case, model, cautious=False))
    )
    error = math.sqrt(sum(entry.error**2 for entry in entries))
    together = measure_together(case, model, error, cautious=False)
    if together > MORE_TOGETHER * error:
        # Interaction error: joint error of all choices without the sum of their separate errors.
        reason = f"on {case.pings(model)} {percent(together)}, which is more than each by itself"
        interaction = math.sqrt(together**2 - error**2)
        entries = (*entries, PlanEntry("together", "all choices together", reason, error=interaction))
        error = together
    # The costs of what is modelled multiply one another; scaled, they add up to that of a ping.
    apart = sum(entry.cost for entry in entries if entry.modelled)
    share = cost / apart if apart > 0.0 else 1.0
    entries = tuple(replace(entry, cost=share * entry.cost) if entry.modelled else entry for entry in entries)
    return Plan(model, entries, error, Planes().near_error(case, model), case.work(model), cost)


def keep_plan(packed: PackedScene, last: Plan, method: str, forced: Mapping[str, str]) -> Plan:
    """Keep the plan of a similar scene where the geometry of this one admits it, without measuring anything."""
    case, model = Case(packed, _requested(method, forced), forced), Model()
    for choice in STAGED:
        model = model._replace(**{choice.field: choice.kept(case, model, last.model)})
        choice.require(case, model)
    return last if model == last.model else Plan(model)


def _requested(method: str, forced: Mapping[str, str]) -> str:
    return forced.get("method", AUTO) if method == AUTO else method


class _Errors:
    """Errors of the settings of all choices, each computed once; 0 for the finest setting."""

    def __init__(self, case: Case) -> None:
        self._case = case
        self._known: dict[tuple[str, Any, str], float] = {}

    def of(self, choice: Choice, model: Model) -> float:
        """Error of a model's setting of one choice."""
        key = choice.subject, choice.measured_with(model), model.method
        if key not in self._known:
            finest = getattr(model, choice.field) == choice.settings(self._case, model)[-1]
            self._known[key] = 0.0 if finest else choice.error(self._case, model)
        return self._known[key]

    def square(self, choices: Iterable[Choice], model: Model, most: float = math.inf) -> float:
        """Sum of the squares of a model's errors; what is beyond a bound is not measured further."""
        total = 0.0
        for choice in choices:
            if total <= most:
                total += self.of(choice, model) ** 2
        return total


def _cheapest(case: Case, tolerance: float) -> Model:
    """Model of the least work with errors within the tolerance; errors of the finest settings do not count.

    Errors as measured and counts of work do not depend on the tolerance, and no model of less work is passed over: more
    tolerance never means more work. Errors of fineness take longest and are measured last, only where they are needed.
    """
    errors, order = _Errors(case), itertools.count()
    queue: list[tuple[float, int, int, int, float, Model]] = []

    def add(model: Model, square: float) -> None:
        heappush(queue, (case.work(model), model.rays, -model.every, next(order), square, model))

    models = [Model()]
    for choice in COARSE:
        models = [made for model in models for made in _viable(case, choice, model, tolerance, errors)]
    for model in models:
        coarsest = {choice.field: choice.settings(case, model)[0] for choice in FINE}
        add(model._replace(**coarsest), errors.square(COARSE, model))
    known = set()
    while True:
        *_, square, model = heappop(queue)
        alone = not queue
        for finer in _finer(case, model):
            if finer not in known:
                known.add(finer)
                add(finer, square)
        if queue and queue[0][0] < case.work(model):  # a finer one takes less work, and is looked at before
            add(model, square)
            continue
        apart = math.sqrt(square + errors.square(FINE, model, tolerance**2 - square))
        if apart <= tolerance and (alone or measure_together(case, model, apart) <= tolerance):
            return model


def _viable(case: Case, choice: Choice, model: Model, tolerance: float, errors: _Errors) -> list[Model]:
    """Models with those settings of one choice that can be simulated and have an error within the tolerance."""
    made = [model._replace(**{choice.field: value}) for value in reversed(choice.settings(case, model))]
    made = made[:1] + list(takewhile(lambda one: errors.of(choice, one) <= tolerance, made[1:]))
    able = []
    for one in made:
        with suppress(SceneError):
            choice.require(case, one)
            able.append(one)
    if not able:
        choice.require(case, made[0])
    return able


def _finer(case: Case, model: Model) -> Iterator[Model]:
    """Models with the next finer setting of a choice of fineness, and with those of less work than the one before."""
    # More planes may take less work: where they lie densely enough for the targets, none are laid between.
    for choice in FINE:
        values = choice.settings(case, model)
        following = values.index(getattr(model, choice.field)) + 1
        finer = [model._replace(**{choice.field: value}) for value in values[following:]]
        yield from finer[:1]
        yield from (one for before, one in itertools.pairwise(finer) if case.work(one) < case.work(before))
