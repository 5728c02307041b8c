"""Report of a chosen model: an entry for every choice, with its reason, error and cost."""

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
    """Chosen candidate with all that its report refers to."""

    scene: Scene
    view: SceneSummary
    candidate: Candidate
    errors: PredictedErrors
    asked: str
    forced: Overrides

    def entry(
        self, subject: str, choice: str, reason: str, options: tuple[str, ...] = (), *, error: float = 0.0
    ) -> PlanEntry:
        """Make the entry of a choice that costs nothing by itself."""
        return PlanEntry(subject, choice, reason, error=error, options=options, forced=subject in self.forced)

    def switch(
        self, subject: str, choice: str, reason: str, with_it: Candidate, without: Candidate, error: float
    ) -> PlanEntry:
        """Make the entry of an effect that is modelled or left out, with the cost of modelling it."""
        modelled = self.candidate == with_it
        adds = predict_cost(self.view, with_it) - predict_cost(self.view, without)
        missed = 0.0 if modelled else error
        return PlanEntry(subject, choice, reason, modelled, missed, adds, SWITCH, subject in self.forced)


def describe_model(model: ChosenModel) -> tuple[tuple[PlanEntry, ...], float]:
    """Describe a chosen model: its entries, and the root sum of squares of their errors."""
    entries = (
        *_method(model),
        *_fineness(model),
        *_spacing(model),
        *_sound(model),
        *_targets(model),
        *_ways(model),
        *_bounces(model),
        *_precision(model),
        *_remarks(model),
    )
    return entries, math.sqrt(sum(entry.error**2 for entry in entries))


def _method(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entry of the tracer, with the cost of its simplest use."""
    scene, candidate = model.scene, model.candidate
    if model.asked != "auto":
        reason = "as requested"
    elif candidate.bounces > 0:
        reason = f"{candidate.bounces} bounces require single rays"
    elif candidate.method == "rays":
        reason = "the sound speed varies along the range, which requires single rays"
    else:
        reason = "a height field and first echoes do not require single rays"
    plain = Candidate(candidate.method, rays=candidate.rays, step=candidate.step, every=candidate.every)
    options = () if scene.receiver.speckle.interferes else METHODS[1:]
    error = model.errors.tracer(candidate) if candidate.method == "sweep" else 0.0
    whole = model.entry("method", candidate.method, reason, options, error=error)
    yield replace(whole, cost=predict_cost(model.view, plain))


def _fineness(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entry of the number of planes or rays, or of the step."""
    scene, candidate = model.scene, model.candidate
    error = model.errors.tracer(candidate)
    if candidate.method == "march":
        reason = f"{candidate.rays} rays per side; the march can step over anything thinner than a step"
        yield model.entry("step", f"steps of {candidate.step:.3g} m", reason, NUMBERS["step"].offered, error=error)
    elif candidate.method == "rays":
        reason = f"{candidate.rays} rays per side: error about {100 * error:.2g} %"
        yield model.entry("rays", f"{candidate.rays} rays", reason, NUMBERS["rays"].offered, error=error)
    elif not scene.sonar.beam.has_width:
        yield model.entry("planes", "1 plane", "a knife-edge beam has no width")
    else:
        yield _planes(model)


def _planes(model: ChosenModel) -> PlanEntry:
    """Entry of the planes across the beam."""
    view, candidate, errors = model.view, model.candidate, model.errors
    error = errors.planes(candidate.ways).error(candidate.planes)
    reason = f"the main lobe of a {model.scene.sonar.beam.words} is {view.width:.3g} m wide at {view.reach:g} m"
    demand = errors.demand
    of_targets = demand.error / candidate.planes**fitted_laws.TARGET_ORDER if candidate.targets else 0.0
    if model.scene.seabed.relief.level and of_targets == 0.0:
        reason += "; the bed has no relief"
    else:
        what = f"a cell of the bed is {view.spacing:.3g} m wide"
        if demand.most and of_targets > 0.5 * error:
            most = demand.most
            what = f"{most.kind} {most.number}, {most.distance:.3g} m away, needs the most planes"
        apart = f"{candidate.planes} planes lie {view.width / candidate.planes:.2g} m apart there"
        planes = apart if candidate.planes > 1 else "one plane represents the whole beam"
        reason += f"; {planes}; {what}: error about {100 * error:.2g} %"
    choice = f"{candidate.planes} plane{'s' * (candidate.planes > 1)}"
    plain = Candidate("sweep", every=candidate.every)
    adds = predict_cost(view, plain._replace(planes=candidate.planes)) - predict_cost(view, plain)
    return replace(model.entry("planes", choice, reason, NUMBERS["planes"].offered, error=error), cost=adds)


def _spacing(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entry of the nodes of the relief that are kept."""
    every, spacing, options = model.candidate.every, model.view.spacing, NUMBERS["spacing"].offered
    if every == 1:
        yield model.entry("spacing", "every node of the relief", f"{spacing:.3g} m apart", options)
        return
    error = model.errors.left_out(model.candidate)["spacing"]
    finest = 2.0 * every * spacing
    level = model.scene.seabed.relief.level
    lost = "a level bed has no detail" if level else f"waves shorter than {finest:.3g} m are left out"
    reason = f"{every * spacing:.3g} m apart instead of {spacing:.3g} m; {lost}: error about {100 * error:.2g} %"
    whole = Candidate("sweep", model.candidate.planes)
    saved = predict_cost(model.view, whole) - predict_cost(model.view, whole._replace(every=every))
    choice = f"detail between every {every} nodes of the relief"
    yield PlanEntry("spacing", choice, reason, False, error, saved, options, "spacing" in model.forced)


def _sound(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entry of refraction and its effect; none in water of constant sound speed."""
    bending, view, candidate = model.errors.bending, model.view, model.candidate
    if bending.most == 0.0:
        return
    reason = (
        f"refraction shifts the farthest echo of the bed by {bending.shift:.2g} m (a bin is {view.bin_length:.3g} m) "
        f"and changes its level by {f'{100.0 * bending.level:.2g} %' if bending.level < 1.0 else 'more than half'}"
    )
    if not candidate.bent:
        reason = f"{reason}; without it the error is about {100.0 * model.errors.straight:.2g} %"
    elif candidate.method != "sweep" or model.scene.water.varies_along:
        reason = f"rays follow circular arcs; {reason}"
    else:
        ways = f"where several eigenrays or none reach a place, a ping is traced with {candidate.rays} rays per side"
        reason = f"tables of apparent positions; {reason}; {ways}"
    choice = "refraction"
    pair = candidate._replace(bent=True), candidate._replace(bent=False)
    yield model.switch("bending", choice, reason, *pair, model.errors.straight)


def _targets(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entries of the targets within reach and of those out of reach."""
    errors, candidate = model.errors, model.candidate
    for subject, of in (("targets", errors.targets), ("far_targets", errors.far_targets)):
        if not of:
            continue
        heard = set(of) <= set(candidate.targets)
        others = tuple(k for k in candidate.targets if k not in of)
        pair = candidate._replace(targets=tuple(sorted((*others, *of)))), candidate._replace(targets=others)
        if subject == "far_targets":
            reason = "too far from the track for any ping"
        else:
            reason = f"within reach of the track{_triangles(model.scene, of)}" if heard else "left out by the user"
        far = " out of reach" if subject == "far_targets" else ""
        yield model.switch(subject, f"{len(of)} target{'s' * (len(of) > 1)}{far}", reason, *pair, 0.0)


def _triangles(scene: Scene, of: tuple[int, ...]) -> str:
    count = sum(outline_of(scene, k).triangles for k in of)
    return f", with {count:,} triangles" if count else ""


def _ways(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entries of the multipaths by the sea surface."""
    surface, view, candidate = model.scene.water.surface, model.view, model.candidate
    images = "from image sources above the surface; objects higher than the sonar do not block the path"
    if surface.rms_height > 0.0:
        height, slope = surface.rms_height, math.degrees(math.sqrt(surface.slope_variance))
        images = (
            "from image sources above the surface; waves of "
            f"{height:.2g} m rms and slopes of {slope:.2g}° rms spread the echo in range"
        )
    for way, first in model.errors.ways.items():
        heard = way in model.errors.heard
        share = model.errors.ghosts.shares.get(way, 0.0) if heard else 0.0
        if way in candidate.ways:
            reason = images
        elif way in model.forced:
            reason = "left out by the user"
        elif heard:
            reason = f"{100 * share:.2g} % of the record"
        else:
            reason = f"its first echo arrives at {first:.3g} m, beyond the range of {view.reach:g} m"
        pair = candidate._replace(ways=candidate.ways | {way}), candidate._replace(ways=candidate.ways - {way})
        yield model.switch(way, f"{surface.kind} sea, {way.replace('_', '-')}", reason, *pair, share)


def _bounces(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entry of the bounces that a scene requests."""
    asked, candidate = model.scene.sonar.bounces, model.candidate
    if asked == 0:
        return
    reason = "specular reflection and transmission after the first echo"
    if candidate.bounces == 0:
        error = model.errors.bounced
        level = (
            "nothing on a level bed without targets" if error == 0.0 else f"at most {100 * error:.2g} % of the record"
        )
        reason = f"later echoes add {level}"
    pair = candidate._replace(bounces=asked), candidate._replace(bounces=0)
    yield model.switch("bounces", f"{asked} bounces", reason, *pair, model.errors.bounced)


def _precision(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entry of the numerical precision of the tracer."""
    if model.candidate.method == "sweep":
        reason = "heights and strengths in 32 bits, times and sums in 64 bits"
        yield model.entry("precision", "32 and 64 bits", reason, error=fitted_laws.SINGLE)
    else:
        yield model.entry("precision", "64 bits", "rays are traced in 64 bits")


def _remarks(model: ChosenModel) -> Iterator[PlanEntry]:
    """Entries that inform about the scene and leave no choice."""
    scene, view = model.scene, model.view
    if scene.receiver.speckle.interferes:
        reason = "coherent speckle sums all scatterers in the beam, which takes most of the time"
        yield model.entry("speckle", "scatterers", reason)
    if scene.track.kinds:
        reason = "each ping has its own position and heading; the sonar does not move during a ping"
        yield model.entry("motion", ", ".join(scene.track.kinds), reason)
    if len(scene.seabed.material.materials) > 1:
        reason = "every cell of the bed has a material, so all nodes are kept"
        yield model.entry("materials", f"{len(scene.seabed.material.materials)} materials", reason)
    apart = scene.track.speed / scene.sonar.ping_rate
    if not scene.sonar.beam.has_width:
        yield model.entry("pings", "pings", f"{apart:.3g} m apart; a knife-edge beam misses anything between two pings")
        return
    # At shorter range the beam is narrower than the distance between pings; nothing lies nearer than the bed.
    covered = apart / (2.0 * math.sin(view.half_width))
    if covered > scene.altitude:
        nearer = f"up to {covered:.3g} m" if covered < view.reach else "at every range"
        reason = f"{apart:.3g} m apart, wider than the beam {nearer}, where a narrow target can be missed"
        yield model.entry("pings", "pings", reason)
