"""A chosen model in words: an entry for every choice, with its reason, error and cost."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from insonify.planning import fitted_laws
from insonify.planning.candidates import Candidate, predict_cost
from insonify.planning.overrides import METHODS, NUMBERS, SWITCH, Overrides
from insonify.planning.plan_entries import PlanEntry
from insonify.planning.predicted_errors import PredictedErrors
from insonify.planning.scene_summary import SceneSummary
from insonify.planning.target_errors import outline_of
from insonify.scene import Scene


class ChosenModel(NamedTuple):
    """All that the words are made of."""

    scene: Scene
    view: SceneSummary
    draft: Candidate
    errors: PredictedErrors
    asked: str
    forced: Overrides

    def entry(
        self, subject: str, choice: str, reason: str, options: tuple[str, ...] = (), *, error: float = 0.0
    ) -> PlanEntry:
        """Make an entry of something that is modelled and costs nothing by itself."""
        return PlanEntry(subject, choice, reason, error=error, options=options, forced=subject in self.forced)

    def switch(
        self, subject: str, choice: str, reason: str, with_it: Candidate, without: Candidate, error: float
    ) -> PlanEntry:
        """Make an entry of something that is there or not, at the cost of its being there."""
        modelled = self.draft == with_it
        adds = predict_cost(self.view, with_it) - predict_cost(self.view, without)
        missed = 0.0 if modelled else error
        return PlanEntry(subject, choice, reason, modelled, missed, adds, SWITCH, subject in self.forced)


def describe_model(told: ChosenModel) -> tuple[tuple[PlanEntry, ...], float]:
    """Put a chosen model into words; return its entries and their errors together, as of independent ones."""
    entries = (
        *_method(told),
        *_fineness(told),
        *_spacing(told),
        *_sound(told),
        *_targets(told),
        *_ways(told),
        *_bounces(told),
        *_precision(told),
        *_remarks(told),
    )
    return entries, math.sqrt(sum(entry.error**2 for entry in entries))


def _method(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell the tracer, at the cost of its plainest use."""
    scene, draft = told.scene, told.draft
    if told.asked != "auto":
        reason = "asked for"
    elif draft.bounces > 0:
        reason = f"{draft.bounces} bounces need single rays"
    elif draft.method == "rays":
        reason = "in water that differs along the level each ray bends in its own way"
    else:
        reason = "a height field and first echoes: nothing needs single rays"
    plain = Candidate(draft.method, rays=draft.rays, step=draft.step, every=draft.every)
    options = () if scene.receiver.speckle.interferes else METHODS[1:]
    error = told.errors.tracer(draft) if draft.method == "sweep" else 0.0
    whole = told.entry("method", draft.method, reason, options, error=error)
    yield replace(whole, cost=predict_cost(told.view, plain))


def _fineness(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell the planes, rays or steps."""
    scene, draft = told.scene, told.draft
    error = told.errors.tracer(draft)
    if draft.method == "march":
        reason = f"{draft.rays} rays a side; what is thinner than a step can be stepped over"
        yield told.entry("step", f"steps of {draft.step:.3g} m", reason, NUMBERS["step"].offered, error=error)
    elif draft.method == "rays":
        reason = f"{draft.rays} a side, error about {100 * error:.2g} %"
        yield told.entry("rays", f"{draft.rays} rays", reason, NUMBERS["rays"].offered, error=error)
    elif not scene.sonar.beam.has_width:
        yield told.entry("planes", "1 plane", "a knife beam has no width")
    else:
        yield _planes(told)


def _planes(told: ChosenModel) -> PlanEntry:
    """Tell the planes across a beam."""
    view, draft, errors = told.view, told.draft, told.errors
    error = errors.planes(draft.ways).error(draft.planes)
    reason = f"the main lobe of a {told.scene.sonar.beam.words} is {view.width:.3g} m wide at {view.reach:g} m"
    demand = errors.demand
    of_targets = demand.error / draft.planes**fitted_laws.TARGET_ORDER if draft.targets else 0.0
    if told.scene.seabed.relief.level and of_targets == 0.0:
        reason += ", over a bed without relief"
    else:
        what = f"a cell of the bed is {view.spacing:.3g} m"
        if demand.most and of_targets > 0.5 * error:
            most = demand.most
            what = f"of the targets, {most.kind} {most.number} {most.distance:.3g} m away asks for most"
        apart = f"{draft.planes} planes lie {view.width / draft.planes:.2g} m apart there"
        planes = apart if draft.planes > 1 else "one plane stands for it all"
        reason += f"; {planes}, {what}: error about {100 * error:.2g} %"
    choice = f"{draft.planes} plane{'s' * (draft.planes > 1)}"
    plain = Candidate("sweep", every=draft.every)
    adds = predict_cost(view, plain._replace(planes=draft.planes)) - predict_cost(view, plain)
    return replace(told.entry("planes", choice, reason, NUMBERS["planes"].offered, error=error), cost=adds)


def _spacing(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell which nodes of the relief are kept."""
    every, spacing, options = told.draft.every, told.view.spacing, NUMBERS["spacing"].offered
    if every == 1:
        yield told.entry("spacing", "every node of the relief", f"{spacing:.3g} m apart", options)
        return
    error = told.errors.left_out(told.draft)["spacing"]
    finest = 2.0 * every * spacing
    level = told.scene.seabed.relief.level
    lost = "a level bed has no detail" if level else f"waves shorter than {finest:.3g} m are left out"
    reason = f"{every * spacing:.3g} m apart in place of {spacing:.3g} m; {lost}: error about {100 * error:.2g} %"
    whole = Candidate("sweep", told.draft.planes)
    saved = predict_cost(told.view, whole) - predict_cost(told.view, whole._replace(every=every))
    choice = f"detail between every {every} nodes of the relief"
    yield PlanEntry("spacing", choice, reason, False, error, saved, options, "spacing" in told.forced)


def _sound(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell whether sound bends, and what it would matter; nothing of water that is the same everywhere."""
    bending, view, draft = told.errors.bending, told.view, told.draft
    if bending.most == 0.0:
        return
    reason = (
        f"it moves the farthest echo of the bed by {bending.shift:.2g} m, a bin is {view.bin_length:.3g} m, and its "
        f"level by {f'{100.0 * bending.level:.2g} %' if bending.level < 1.0 else 'more than half'}"
    )
    if not draft.bent:
        reason = f"bending is left out; {reason}: error about {100.0 * told.errors.straight:.2g} %"
    elif draft.method != "sweep" or told.scene.water.varies_along:
        reason = f"along arcs; {reason}"
    else:
        ways = f"pings that hear a place along several ways or none go to {draft.rays} rays a side"
        reason = f"by tables of the water; {reason}; {ways}"
    choice = "bent sound" if draft.bent else "straight sound"
    pair = draft._replace(bent=True), draft._replace(bent=False)
    yield told.switch("bending", choice, reason, *pair, told.errors.straight)


def _targets(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell the targets in reach, and those that are not."""
    errors, draft = told.errors, told.draft
    for subject, of in (("targets", errors.targets), ("far_targets", errors.far_targets)):
        if not of:
            continue
        heard = set(of) <= set(draft.targets)
        others = tuple(k for k in draft.targets if k not in of)
        pair = draft._replace(targets=tuple(sorted((*others, *of)))), draft._replace(targets=others)
        if subject == "far_targets":
            reason = "too far from the line of the tow to be heard by any ping"
        else:
            reason = f"within reach of the tow{_triangles(told.scene, of)}" if heard else "left out as forced"
        far = " out of reach" if subject == "far_targets" else ""
        yield told.switch(subject, f"{len(of)} target{'s' * (len(of) > 1)}{far}", reason, *pair, 0.0)


def _triangles(scene: Scene, of: tuple[int, ...]) -> str:
    count = sum(outline_of(scene, k).triangles for k in of)
    return f", with {count:,} triangles" if count else ""


def _ways(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell each way by the sea surface."""
    surface, view, draft = told.scene.water.surface, told.view, told.draft
    images = "from images of the sonar above it; what rises higher than the sonar leaves it in sight"
    if surface.rms_height > 0.0:
        height, slope = surface.rms_height, math.degrees(math.sqrt(surface.slope_variance))
        images = (
            "from images of the sonar above it, smeared in range by waves of "
            f"{height:.2g} m rms and slopes of {slope:.2g}° rms, along the beam alone"
        )
    for way, first in told.errors.ways.items():
        heard = way in told.errors.heard
        share = told.errors.ghosts.shares.get(way, 0.0) if heard else 0.0
        if way in draft.ways:
            reason = images
        elif way in told.forced:
            reason = "left out as forced"
        elif heard:
            reason = f"it is {100 * share:.2g} % of the record"
        else:
            reason = f"its first echo comes from {first:.3g} m, beyond the range of {view.reach:g} m"
        pair = draft._replace(ways=draft.ways | {way}), draft._replace(ways=draft.ways - {way})
        yield told.switch(way, f"{surface.kind} sea, {way.replace('_', '-')}", reason, *pair, share)


def _bounces(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell the bounces that a scene asks for."""
    asked, draft = told.scene.sonar.bounces, told.draft
    if asked == 0:
        return
    reason = "mirror-like, and passages, after the first echo"
    if draft.bounces == 0:
        error = told.errors.bounced
        level = "no level bed without targets is met twice" if error == 0.0 else f"at most {100 * error:.2g} %"
        reason = f"left out: what comes after the first echo adds little to the record ({level})"
    pair = draft._replace(bounces=asked), draft._replace(bounces=0)
    yield told.switch("bounces", f"{asked} bounces", reason, *pair, told.errors.bounced)


def _precision(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell what numbers the tracer reckons in."""
    if told.draft.method == "sweep":
        reason = "heights and strengths in 32 bits, time and sums in 64: finer than anything else left out here"
        yield told.entry("precision", "32 and 64 bits", reason, error=fitted_laws.SINGLE)
    else:
        yield told.entry("precision", "64 bits", "rays are walked in 64 bits")


def _remarks(told: ChosenModel) -> Iterator[PlanEntry]:
    """Tell what leaves no choice but should be known."""
    scene, view = told.scene, told.view
    if scene.receiver.speckle.interferes:
        reason = "coherent speckle adds up every one in the beam, which takes most of the time"
        yield told.entry("speckle", "scatterers", reason)
    if scene.track.kinds:
        reason = "each ping from its own place and heading; while one is out the fish stands still"
        yield told.entry("motion", ", ".join(scene.track.kinds), reason)
    if len(scene.seabed.material.materials) > 1:
        reason = "every cell of the bed has its own, so that its nodes are all kept"
        yield told.entry("materials", f"{len(scene.seabed.material.materials)} materials", reason)
    apart = scene.track.speed / scene.sonar.ping_rate
    if not scene.sonar.beam.has_width:
        yield told.entry("pings", "pings", f"{apart:.3g} m apart; a knife-edge beam misses what is narrower")
        return
    # Nearer than this the beam is narrower than the way between two pings; nothing lies nearer than the bed.
    covered = apart / (2.0 * math.sin(view.half_width))
    if covered > scene.altitude:
        nearer = f"nearer than {covered:.3g} m" if covered < view.reach else "at every range"
        reason = f"{apart:.3g} m apart, more than the beam is wide {nearer}; what is narrower can be missed there"
        yield told.entry("pings", "pings", reason)
