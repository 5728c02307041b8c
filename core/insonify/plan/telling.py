"""A chosen model in words: an entry for every choice, with its reason, error and cost."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from insonify.plan import laws
from insonify.plan.across import demand_of, error_of_planes, error_of_rays
from insonify.plan.drafts import Draft, cost
from insonify.plan.entries import Entry
from insonify.plan.forcing import METHODS, NUMBERS, SWITCH, Forced
from insonify.plan.view import View
from insonify.scene import Scene
from insonify.scene.receiver import Coherent
from insonify.scene.sonar import Knife
from insonify.scene.surface import WAYS, RoughSurface
from insonify.scene.water import SectionWater
from insonify.sound.sea_surface import rms_height, slope_variance
from insonify.sound.straightness import Bending


class Told(NamedTuple):
    """All that the words are made of."""

    scene: Scene
    view: View
    draft: Draft
    bending: Bending
    asked: str
    forced: Forced


def entries_of(told: Told) -> tuple[tuple[Entry, ...], float]:
    """Put a chosen model into words; return its entries and their errors together, as of independent ones."""
    entries = (
        *_method(told),
        *_fineness(told),
        *_sound(told),
        *_ways(told),
        *_bounces(told),
        *_targets(told),
        *_spacing(told),
        *_remarks(told),
    )
    return entries, math.sqrt(sum(entry.error**2 for entry in entries))


def _method(told: Told) -> Iterator[Entry]:
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
    plain = Draft(draft.method, rays=draft.rays, step=draft.step)
    options = () if isinstance(scene.receiver.speckle, Coherent) else METHODS[1:]
    yield Entry(
        "method", draft.method, reason, cost=cost(told.view, plain), options=options, forced="method" in told.forced
    )


def _fineness(told: Told) -> Iterator[Entry]:
    """Tell the planes, rays or steps."""
    scene, view, draft, forced = told.scene, told.view, told.draft, told.forced
    if draft.method == "march":
        reason = f"{draft.rays} rays a side; what is thinner than a step can be stepped over"
        error = laws.MARCH * (draft.step / view.spacing) ** laws.MARCH_ORDER
        yield Entry("step", f"steps of {draft.step:.3g} m", reason, error=error, **_number("step", forced))
    elif draft.method == "rays":
        error = error_of_rays(scene, draft.rays)
        reason = f"{draft.rays} a side, error about {100 * error:.2g} %"
        yield Entry("rays", f"{draft.rays} rays", reason, error=error, **_number("rays", forced))
    elif isinstance(scene.sonar.beam, Knife):
        yield Entry("planes", "1 plane", "a knife beam has no width")
    else:
        yield _planes(told)


def _number(subject: str, forced: Forced) -> dict[str, Any]:
    return {"options": NUMBERS[subject].offered, "forced": subject in forced}


def _planes(told: Told) -> Entry:
    """Tell the planes across a beam."""
    view, draft = told.view, told.draft
    demand = demand_of(told.scene, view)
    broad = f"the main lobe of a {told.scene.sonar.beam.words} is {view.width:.3g} m wide at {view.reach:g} m"
    error = error_of_planes(demand, draft.planes)
    reason = f"{broad}, over a bed without detail"
    if demand is not None:
        apart = view.width / draft.planes
        reason = (
            f"{broad}; {draft.planes} planes lie {apart:.2g} m apart there, {demand.of_what}: "
            f"error about {100 * error:.2g} %"
        )
    one = Draft("sweep")
    adds = cost(view, one._replace(planes=draft.planes)) - cost(view, one)
    return Entry(
        "planes",
        f"{draft.planes} plane{'s' * (draft.planes > 1)}",
        reason,
        error=error,
        cost=adds,
        options=NUMBERS["planes"].offered,
        forced="planes" in told.forced,
    )


def _sound(told: Told) -> Iterator[Entry]:
    """Tell whether sound bends, and what it would matter; nothing of water that is the same everywhere."""
    bending, view, draft = told.bending, told.view, told.draft
    if bending.most == 0.0:
        return
    matter = (
        f"it moves the farthest echo of the bed by {bending.shift:.2g} m, a bin is {view.bin_length:.3g} m, and its "
        f"level by {f'{100.0 * bending.level:.2g} %' if bending.level < 1.0 else 'more than half'}"
    )
    adds = cost(view, draft._replace(bent=True)) - cost(view, draft._replace(bent=False))
    switch: dict[str, Any] = {"options": SWITCH, "forced": "bending" in told.forced, "cost": adds}
    if not draft.bent:
        yield Entry(
            "bending",
            "straight sound",
            f"bending is left out; {matter}",
            False,
            error=min(bending.most, 1.0),
            **switch,
        )
    elif draft.method != "sweep" or isinstance(told.scene.water, SectionWater):
        yield Entry("bending", "bent sound", f"along arcs; {matter}", **switch)
    else:
        reason = (
            f"by tables of the water; {matter}; pings that hear a place along several ways or none go to "
            f"{draft.rays} rays a side"
        )
        yield Entry("bending", "bent sound", reason, **switch)


def _ways(told: Told) -> Iterator[Entry]:
    """Tell each way by the sea surface."""
    surface, view, draft = told.scene.water.surface, told.view, told.draft
    images = "from images of the sonar above it; what rises higher than the sonar leaves it in sight"
    if isinstance(surface, RoughSurface):
        height, slope = rms_height(surface.wind_speed), math.degrees(math.sqrt(slope_variance(surface.wind_speed)))
        images = (
            "from images of the sonar above it, smeared in range by waves of "
            f"{height:.2g} m rms and slopes of {slope:.2g}° rms, along the beam alone"
        )
    for way in WAYS:
        if getattr(surface, way, False):
            heard = way in draft.ways
            adds = cost(view, draft._replace(ways=draft.ways | {way})) - cost(
                view, draft._replace(ways=draft.ways - {way})
            )
            reason = images if heard else "left out as forced"
            name = f"{surface.kind} sea, {way.replace('_', '-')}"
            forced = way in told.forced
            yield Entry(way, name, reason, heard, 0.0, adds, SWITCH, forced)


def _bounces(told: Told) -> Iterator[Entry]:
    """Tell the bounces that a scene asks for."""
    asked, draft = told.scene.sonar.bounces, told.draft
    if asked == 0:
        return
    adds = cost(told.view, draft._replace(bounces=asked)) - cost(told.view, draft._replace(bounces=0))
    reason = "mirror-like, and passages, after the first echo" if draft.bounces else "left out as forced"
    options, forced = SWITCH, "bounces" in told.forced
    yield Entry("bounces", f"{asked} bounces", reason, draft.bounces > 0, 0.0, adds, options, forced)


def _targets(told: Told) -> Iterator[Entry]:
    """Tell the targets."""
    count, draft = len(told.scene.targets), told.draft
    if count == 0:
        return
    adds = cost(told.view, draft._replace(targets=count)) - cost(told.view, draft._replace(targets=0))
    reason = "each where it lies" if draft.targets else "left out as forced"
    yield Entry(
        "targets",
        f"{count} target{'s' * (count > 1)}",
        reason,
        draft.targets > 0,
        0.0,
        adds,
        SWITCH,
        "targets" in told.forced,
    )


def _spacing(told: Told) -> Iterator[Entry]:
    """Tell which nodes of the relief are kept."""
    every, spacing = told.draft.every, told.view.spacing
    which = "every node" if every == 1 else f"one in {every} nodes"
    yield Entry(
        "spacing", f"{which} of the relief", f"{every * spacing:.3g} m apart", **_number("spacing", told.forced)
    )


def _remarks(told: Told) -> Iterator[Entry]:
    """Tell what leaves no choice but should be known."""
    scene, view = told.scene, told.view
    if isinstance(scene.receiver.speckle, Coherent):
        reason = "coherent speckle adds up every one in the beam, which takes most of the time"
        yield Entry("speckle", "scatterers", reason)
    if scene.track.kinds:
        reason = "each ping from its own place and heading; while one is out the fish stands still"
        yield Entry("motion", ", ".join(scene.track.kinds), reason)
    apart = scene.track.speed / scene.sonar.ping_rate
    if isinstance(scene.sonar.beam, Knife):
        yield Entry("pings", "pings", f"{apart:.3g} m apart; a knife-edge beam misses what is narrower")
        return
    # Nearer than this the beam is narrower than the way between two pings; nothing lies nearer than the bed.
    covered = apart / (2.0 * math.sin(view.half_width))
    if covered > scene.altitude:
        nearer = f"nearer than {covered:.3g} m" if covered < view.reach else "at every range"
        reason = f"{apart:.3g} m apart, more than the beam is wide {nearer}; what is narrower can be missed there"
        yield Entry("pings", "pings", reason)
