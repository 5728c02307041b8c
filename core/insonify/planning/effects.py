"""Table of what a plan may leave out or trace more coarsely: one row an effect.

A row gives where the effect applies, the settings between which a plan may choose, and the words of a plan. It gives
the error of a setting (a closed bound or a difference measured on a few pings) and its share of the tolerance. Errors
of unlike kinds add up by squares, and the shares are fixed, so that more tolerance never means more work.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from insonify.kernels.sweep.plane_errors import LEAST_PLANES
from insonify.packing.packed_scene import SURFACE_ECHO, Model
from insonify.planning.case import FEWEST_RAYS, NEGLIGIBLE, Case
from insonify.planning.plan_entries import PlanEntry, counted, percent
from insonify.planning.probe import ENOUGH_PINGS, PlaneLaw
from insonify.scene import SceneError
from insonify.scene.water.surfaces import WAYS
from insonify.tracers.base import AUTO, find_tracer, list_methods
from insonify.tracers.plane_counts import COUNTS

SWITCH = ("on", "off")
ONE_OF_FOUR = 1.0 / 6.0  # share of refraction, of paths by the surface, of segments and of nodes
OF_PLANES = math.sqrt(1.0 - 4.0 * ONE_OF_FOUR**2)  # share of planes, or of rays: the squares add up to one
FEW_PLANES, MANY_PLANES = 4, 16  # by which errors of planes are measured first
MOST_MEASURED = 256
OF_A_TARGET = 4  # planes across each target and each glint, where a ping has no more of all
# Rays per side of the sweep's pings with several eigenrays or none; each number is judged by the next.
RAYS_STEP, FOLDED_RAYS = 4, (4000, 16_000, 64_000)
PINGS_OF_MOST_RAYS = 4  # pings traced with the most of them, a second of one core at the longest ranges
STRIDES, FEWEST_CELLS = (1, 2, 4, 8, 16, 32), 8  # of nodes; cells that a period of the bed keeps
NEARER = 1.0 / 3.0  # weight of the error over all bins, the strong ones near nadir too: three times the tolerance
DIVISIONS = (math.inf, 0.03, 0.01, 0.003)  # share of a bin's echo that a segment may misplace
REFUSED = 2.0  # times its share by which the least error of a setting refuses it unmeasured
HALVINGS = 7  # of the march's step, from a cell of the bed


class Said(NamedTuple):
    """What a plan says of an effect."""

    choice: str
    reason: str
    modelled: bool = True
    without: Model | None = None  # model by which it saves, or takes, time
    options: tuple[str, ...] | None = None  # those of the row


@dataclass(frozen=True, eq=False)
class Effect:
    """One row of the table."""

    subject: str  # name by which it is forced
    field: str  # field of the `Model` that it sets
    settings: Callable[[Case, Model, Any], tuple[Any, ...]]  # coarse to fine, with a forced one or None
    say: Callable[[Case, Model, float], Said | None]  # None where it does not concern the scene
    error: Callable[[Case, Model], float] = lambda case, model: 0.0  # of a model's setting
    share: float = ONE_OF_FOUR  # of the tolerance that it may err by
    offered: tuple[str, ...] = SWITCH  # settings offered to a user
    bounds: tuple[float, float] | None = None  # of a number, which is whole where the first is
    closed: Callable[[Case, Model], tuple[float, float]] = lambda case, model: (0.0, math.inf)  # bounds on the error
    probes: Callable[[Case], tuple[Model, ...]] = lambda case: ()  # models that its errors compare first

    def parse(self, text: str) -> Any:
        """Read a forced setting; raises a `SceneError` if it is not known."""
        if self.bounds is None:
            return _read_choice(self, text)
        low, high = self.bounds
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        is_whole = isinstance(low, int)
        if not low <= number <= high or (is_whole and number != int(number)):
            kind = "a whole number" if is_whole else "a number"
            raise SceneError(f"model {self.subject}: {text!r} is not valid; give {kind} from {low:g} to {high:g}")
        return int(number) if is_whole else number

    def judge(self, case: Case, model: Model, tolerance: float) -> float:
        """Error of a model's setting: its bound where that decides whether it may be chosen, otherwise as measured."""
        lower, upper = (0.0, math.inf) if self.subject in case.forced else self.closed(case, model)
        most = self.share * tolerance
        return upper if upper <= most else lower if lower > REFUSED * most else self.error(case, model)

    def values(self, case: Case, model: Model) -> tuple[Any, ...]:
        """Values of the field to consider with the choices already made, coarse to fine; one if there is no choice."""
        forced = case.forced.get(self.subject)
        return self.settings(case, model, None if forced is None else self.parse(forced))


def _read_choice(effect: Effect, text: str) -> Any:
    """Read one of the settings that a row offers."""
    if effect.subject == "method":
        if text != AUTO:
            find_tracer(text)
        return text
    if text not in effect.offered:
        known = ", ".join(effect.offered)
        raise SceneError(f"model {effect.subject}: {text!r} is not known; choose one of {known}")
    if effect.subject == "segments":
        return math.inf if text == "whole" else float(text)
    return text == "on"


def applies(model: Model, field: str) -> bool:
    """Whether the tracer of a model is made finer by a field."""
    return field in find_tracer(model.method).fineness


# The tracer


def _methods(case: Case, model: Model, wish: Any) -> tuple[str, ...]:
    return (case.choose_tracer(model) if case.requested == AUTO else case.requested,)


def _say_method(case: Case, model: Model, error: float) -> Said:
    reason = "a height field and first echoes do not require single rays"
    if case.requested != AUTO:
        reason = "as requested"
    elif model.bounces > 0:
        reason = f"{model.bounces} bounces require single rays"
    elif model.method != case.choose_tracer(Model()):
        reason = "the sound speed varies along the range, which requires single rays"
    options = () if case.scene.receiver.speckle.interferes else list_methods()[1:]
    return Said(model.method, reason, options=options)


# Planes across the beam, and across targets


def plane_law(case: Case, across: int, planes: int = FEW_PLANES) -> PlaneLaw:
    """Errors by the number of planes, measured by that number, or the most affordable, beside the finest of effects."""
    few, pings = max(planes, LEAST_PLANES), case.probe.size  # a ping that meets targets has several
    while few > FEW_PLANES and not _is_affordable(case, across, 2 * few):
        few //= 2
    if few == FEW_PLANES or pings < ENOUGH_PINGS:
        return case.probe.law(*_planes_probed(case, across), pings)
    pair = _planes_probed(case, across, few, max(2 * few, MANY_PLANES))
    return case.probe.law(*pair, max(pings // 2, ENOUGH_PINGS))


def _is_affordable(case: Case, across: int, planes: int) -> bool:
    return planes <= MOST_MEASURED and case.probe.affords(_planes_probed(case, across, planes)[0])


def _planes_probed(case: Case, across: int, few: int = FEW_PLANES, many: int = MANY_PLANES) -> tuple[Model, Model]:
    some = case.whole._replace(ways=case.measured_paths, across=across)
    return some._replace(planes=few), some._replace(planes=many)


def _planes(case: Case, model: Model, wish: Any) -> tuple[int, ...]:
    if not (applies(model, "planes") and case.scene.sonar.beam.has_width):
        return (1,)
    if wish is not None:
        return (wish,)
    interferes = case.scene.receiver.speckle.interferes
    if case.is_level and not interferes:
        return (1,)
    # A single plane stands for a whole beam over a level bed, but for borders of its materials.
    single = (1,) if case.scene.seabed.relief.level and not interferes else ()
    return single + tuple(count for count in COUNTS if count >= LEAST_PLANES)


def planes_error(case: Case, model: Model) -> float:
    """Error of a number of planes by the law that is measured; none for a beam without width."""
    if "planes" not in case.forced:
        if _planes(case, model, None) == (1,):
            return 0.0
        if model.planes == 1:  # over a level bed of several materials, which pings do not measure themselves
            many = _planes_probed(case, model.across)[1]
            return case.probe.difference(many._replace(planes=1), many, nearer=1.0)
    return plane_law(case, model.across).of(model.planes)


def _say_planes(case: Case, model: Model, error: float) -> Said | None:
    if not applies(model, "planes"):
        return None
    if not case.scene.sonar.beam.has_width:
        return Said("1 plane", "a knife-edge beam has no width", options=())
    forced = "planes" in case.forced
    if error == 0.0:
        reason = "a level bed of one material is alike across the beam; a ping that meets a target has several"
    elif model.planes == 1 and not forced:
        reason = f"on a level bed, 1 and {MANY_PLANES} planes differ by {percent(error)} on {case.pings}"
    else:
        law = plane_law(case, model.across)
        reason = f"{law.few} and {law.many} planes differ by {percent(law.error)} on "
        reason += f"{case.pings}; estimated error with {model.planes}: {percent(error)}"
        if not forced:
            reason += "; a ping of a greater error than the tolerance has more"
    alike = model._replace(across=0)
    return Said(counted(model.planes, "plane"), reason, without=alike._replace(planes=1))


def _across(case: Case, model: Model, wish: Any) -> tuple[int, ...]:
    counts = applies(model, "planes") and case.scene.sonar.beam.has_width and case.targets
    return (OF_A_TARGET if wish is None else wish,) if counts else (0,)


def _say_across(case: Case, model: Model, error: float) -> Said | None:
    if not _across(case, model, None)[0]:
        return None
    reason = "at least as many across each target in the beam and each glint, with a border at each end of a target"
    return Said(f"{model.across} planes across each target", reason, without=model._replace(across=0))


# Rays, steps, and what other tracers count: ladders of doublings, each rung judged by the next


def _is_sweep(model: Model) -> bool:
    return "planes" in find_tracer(model.method).fineness


def _ladder_of(field: str) -> Callable[[Case, Model, Any], tuple[Any, ...]]:
    def settings(case: Case, model: Model, wish: Any) -> tuple[Any, ...]:
        tracer, ladder = find_tracer(model.method), find_tracer(model.method).ladder
        is_none = not applies(model, field) or (_is_sweep(model) and not model.bent)
        if is_none or (ladder is None and field == "fineness"):
            return (0,)
        if wish is not None:
            return (wish,)
        if field == "step":
            return tuple(case.packed.arrays.bed.spacing / 2**n for n in range(HALVINGS))
        if "step" in tracer.fineness:
            return (case.scene.sonar.bins,)
        if ladder is not None:
            return tuple(ladder.first << n for n in range((ladder.last // ladder.first).bit_length()))
        return FOLDED_RAYS if case.folds else FOLDED_RAYS[:1]

    return settings


def _pair(case: Case, model: Model, field: str, doublings: int = 0) -> tuple[Model, Model]:
    """Models some doublings coarser, and of one doubling more, by which the first is judged."""
    if field == "step":
        model = Model(model.method, rays=model.rays, step=model.step * 2.0**doublings, bent=case.bent)
        model = model._replace(bounces=model.bounces, targets=case.targets, ways=case.paths)
        return model, model._replace(step=0.5 * model.step, rays=2 * model.rays)
    number = getattr(model, field) // 2**doublings
    coarse: dict[str, Any] = {field: number}
    fine: dict[str, Any] = {field: 2 * number}
    return model._replace(**coarse), model._replace(**fine)


def _is_on_ladder(case: Case, model: Model, field: str) -> bool:
    """Whether a setting is no coarser than a tracer's coarsest."""
    ladder = find_tracer(model.method).ladder
    if field == "step":
        return model.step <= case.scene.sonar.range
    return bool(getattr(model, field) >= (ladder.first if ladder else 1))


def _measured_doublings(case: Case, model: Model, field: str) -> int:
    """Doublings from a model's setting to the finest that the probe affords to judge."""
    doublings = 0
    while not case.probe.affords(_pair(case, model, field, doublings)[1]):
        if not _is_on_ladder(case, _pair(case, model, field, doublings + 1)[0], field):
            break
        doublings += 1
    return doublings


def _ladder_error(field: str) -> Callable[[Case, Model], float]:
    def error(case: Case, model: Model) -> float:
        """Error of the finest setting that is measured; a finer one falls with the power, of ½ to 1, last measured."""
        if not getattr(model, field) or find_tracer(model.method).fineness[0] != field:
            return _folded_error(case, model) if field == "rays" and _is_sweep(model) and model.rays else 0.0
        doublings = _measured_doublings(case, model, field)
        pair, coarser = (_pair(case, model, field, n) for n in (doublings, doublings + 1))
        if not _is_on_ladder(case, coarser[0], field):
            return case.probe.difference(*pair)
        # Steps change with the rays beside them, of which the trend says nothing.
        found = case.probe.difference(*pair, before=None if field == "step" else coarser[0])
        if doublings == 0 or found == 0.0:
            return found
        fall = math.log2(max(case.probe.difference(*coarser) / found, 1.0))
        # Without more rays beside them, shorter steps may not help.
        return found * 2.0 ** -(doublings * min(max(fall, 0.0 if field == "step" else 0.5), 1.0))

    return error


def _folded_error(case: Case, model: Model) -> float:
    """Error of single rays where the sweep leaves pings to them, from the next number of rays.

    Many rays take long, so the fall of more than the fewest is measured on the loudest pings: their errors count most.
    """
    if not case.folds:
        return 0.0

    def step(rays: int, of: tuple[int, ...] = ()) -> float:
        pair = (case.whole._replace(rays=number) for number in (rays, RAYS_STEP * rays))
        return case.probe.difference(*pair, of=of)

    fewest, more, most = FOLDED_RAYS
    if model.rays <= fewest:
        return step(model.rays)
    loudest = case.probe.loudest(case.whole._replace(rays=more), PINGS_OF_MOST_RAYS)
    of = loudest if step(fewest, loudest) > 0.0 else ()  # none of the loudest is left to rays
    before = step(fewest, of)
    fall = step(more, of) / before if before > 0.0 else RAYS_STEP**-0.5
    beyond = 1.0 if model.rays < most else min(max(fall, 1.0 / RAYS_STEP), RAYS_STEP**-0.5)
    return step(fewest) * fall * beyond


def _say_ladder(field: str) -> Callable[[Case, Model, float], Said | None]:
    def say(case: Case, model: Model, error: float) -> Said | None:
        number, tracer = getattr(model, field), find_tracer(model.method)
        if not number or (field == "rays" and "step" in tracer.fineness):
            return None
        words = tracer.ladder.counted if tracer.ladder else "rays per side"
        choice = f"steps of {number:.3g} m" if field == "step" else f"{number} {'rays' if field == 'rays' else words}"
        if tracer.fineness[0] != field:
            reason = f"where several eigenrays or none reach a place, a ping is traced with {number} rays per side"
            return Said(choice, reason)
        doublings = _measured_doublings(case, model, field)
        coarse, fine = _pair(case, model, field, doublings)
        measured = f"{percent(case.probe.difference(coarse, fine))} on {case.pings}"
        if field == "step":
            reason = f"steps of {coarse.step:.3g} m and of half that with twice the rays differ by {measured}"
        else:
            reason = f"{getattr(coarse, field)} and {getattr(fine, field)} {words} differ by {measured}"
        if doublings:
            reason = f"estimated error with {choice}: {percent(error)} ({reason})"
        if field == "step":
            reason = f"{model.rays} rays per side; {reason}; the march can step over anything thinner than a step"
        return Said(choice, reason)

    return say


# Segments and nodes of the bed


def _segments(case: Case, model: Model, wish: Any) -> tuple[float, ...]:
    if not applies(model, "misplaced"):
        return (math.inf,)
    return DIVISIONS if wish is None else (wish,)


def _segments_error(case: Case, model: Model) -> float:
    """Error against the finest division; the error of other divisions falls in proportion to the share misplaced."""
    finest = case.bare._replace(misplaced=DIVISIONS[-1])
    if model.misplaced == math.inf:
        return case.probe.difference(case.bare, finest, nearer=NEARER)
    coarsest = finest._replace(misplaced=DIVISIONS[1])
    return case.probe.difference(coarsest, finest, nearer=NEARER) * model.misplaced / DIVISIONS[1]


def _segments_closed(case: Case, model: Model) -> tuple[float, float]:
    """Bound on the error of whole segments: docs/theory/sweep.md, Division, without the terms of oblique planes."""
    if not applies(model, "misplaced"):
        return 0.0, 0.0
    return (0.0, case.whole_segments_bound if model.misplaced == math.inf else math.inf)


def _segments_probes(case: Case) -> tuple[Model, ...]:
    return () if "segments" in case.forced else (case.bare, case.bare._replace(misplaced=DIVISIONS[-1]))


def _say_segments(case: Case, model: Model, error: float) -> Said | None:
    if not applies(model, "misplaced"):
        return None
    if model.misplaced == math.inf:
        reason = f"one angle of incidence for each cell of the bed; {percent(error)} "
        reason += "at most" if error == case.whole_segments_bound else f"from the finest division on {case.pings}"
        return Said("incidence within cells of the bed", reason, False, model._replace(misplaced=DIVISIONS[1]))
    choice = f"segments divided to {percent(model.misplaced)} of a bin's echo"
    reason = "the angle of incidence varies within each cell of the bed"
    return Said(choice, reason, without=model._replace(misplaced=math.inf))


def _spacing(case: Case, model: Model, wish: Any) -> tuple[int, ...]:
    """Strides that divide the period of the bed; every node of a measured or endless bed."""
    seabed = case.scene.seabed
    cells = {round(part.period / seabed.spacing) for part in seabed.random_reliefs if not part.endless}
    if wish is not None:
        if any(count % wish for count in cells):
            raise SceneError(
                f"model spacing: '{wish}' does not divide the {min(cells)} cells after which the bed repeats; "
                "give a number that does, such as 1"
            )
        return (wish,)
    # To make endless ground again for each stride takes far longer than to trace all of its nodes.
    if not seabed.random_reliefs or seabed.endless or not applies(model, "every"):
        return (1,)
    return tuple(n for n in STRIDES[::-1] if n == 1 or all(c % n == 0 and c >= FEWEST_CELLS * n for c in cells))


def _lost_slopes(case: Case, every: int) -> float:
    """Error of a Lambert bed that loses the slopes between nodes, to the first order: 2 δ / tan(grazing angle)."""
    farthest = case.scene.sonar.range / max(case.scene.altitude, 1e-9)
    return 2.0 * case.slope_between(every) * math.sqrt((1.0 + farthest + farthest**2) / 3.0)


def _spacing_error(case: Case, model: Model) -> float:
    return case.probe.difference(case.bare._replace(every=model.every), case.bare, nearer=NEARER)


def _spacing_closed(case: Case, model: Model) -> tuple[float, float]:
    """Bounds: the first order, which is not measured where it is far beyond what is allowed."""
    return (0.0, 0.0) if model.every == 1 else (_lost_slopes(case, model.every), math.inf)


def _say_spacing(case: Case, model: Model, error: float) -> Said:
    spacing = case.scene.seabed.spacing
    if model.every == 1:
        reason = f"{spacing:.3g} m apart"
        values = _spacing(case, model, None)
        if len(values) > 1:
            reason += f"; half of them would change the record by about {percent(_lost_slopes(case, values[-2]))}"
        return Said("every node of the relief", reason)
    reason = f"{model.every * spacing:.3g} m apart instead of {spacing:.3g} m; on {case.pings} {percent(error)}"
    return Said(f"detail between every {model.every} nodes of the relief", reason, False, model._replace(every=1))


# Physical effects


def _bending(case: Case, model: Model, wish: Any) -> tuple[bool, ...]:
    if not case.packed.arrays.water.bent or (wish is None and case.straight_bound < NEGLIGIBLE):
        return (False,)
    return (False, True) if wish is None else (wish,)


def _bending_probed(case: Case) -> tuple[Model, ...]:
    """Straight and refracted rays in the same pings, without paths by the surface."""
    method = case.choose_tracer(Model(bent=True))
    bent = Model(method, rays=FEWEST_RAYS, bent=True, targets=case.targets)
    return bent._replace(bent=False, rays=0 if _is_sweep(bent) else FEWEST_RAYS), bent


def _bending_error(case: Case, model: Model) -> float:
    return 0.0 if model.bent else case.probe.difference(*_bending_probed(case))


def _bending_closed(case: Case, model: Model) -> tuple[float, float]:
    return 0.0, 0.0 if model.bent else case.straight_bound


def _bending_probes(case: Case) -> tuple[Model, ...]:
    return _bending_probed(case) if case.bent and "bending" not in case.forced else ()


def _say_bending(case: Case, model: Model, error: float) -> Said | None:
    if not case.packed.arrays.water.bent:
        return None
    bound = case.straight_bound
    at_most = bound < NEGLIGIBLE or (not model.bent and error == bound)
    missed = bound if at_most else _bending_error(case, model._replace(bent=False))
    reason = f"straight rays are {percent(missed)} from refracted ones"
    reason = f"{reason} at most" if at_most else f"on {case.pings} {reason}"
    if model.bent:
        reason = f"{find_tracer(model.method).refraction}; {reason}"
    return Said("refraction", reason, model.bent, model._replace(bent=not model.bent))


def _near_targets(case: Case, model: Model, wish: Any) -> tuple[tuple[int, ...], ...]:
    """Those within reach unless forced otherwise; geometry decides."""
    return (tuple(sorted({*model.targets, *(() if wish is False else case.near)})),)


def _far(case: Case) -> tuple[int, ...]:
    return tuple(number for number in range(len(case.scene.targets)) if number not in set(case.near))


def _far_targets(case: Case, model: Model, wish: Any) -> tuple[tuple[int, ...], ...]:
    return (tuple(sorted({*model.targets, *(_far(case) if wish else ())})),)


def _say_targets(of: Callable[[Case], tuple[int, ...]], where: str) -> Callable[[Case, Model, float], Said | None]:
    def say(case: Case, model: Model, error: float) -> Said | None:
        some = set(of(case))
        if not some:
            return None
        modelled, reason = some <= set(model.targets), "left out by the user"
        if where:
            reason = "too far from the track for any ping"
        elif modelled:
            triangles = int(case.packed.arrays.mesh.target.size)
            reason = "within reach of the track" + (f", with {triangles:,} triangles" if triangles else "")
        kept = {*model.targets} - some if modelled else {*model.targets} | some
        return Said(
            f"{counted(len(some), 'target')}{where}", reason, modelled, model._replace(targets=tuple(sorted(kept)))
        )

    return say


def _bounces(case: Case, model: Model, wish: Any) -> tuple[int, ...]:
    """None, as many as the scene declares, or both; none over a level bed without targets."""
    declared = case.scene.sonar.bounces
    if declared == 0 or (case.scene.seabed.relief.level and not case.scene.targets):
        return (0,)
    if wish is not None:
        return (declared if wish else 0,)
    return (0, declared) if case.requested == AUTO or find_tracer(case.requested).follows_bounces else (declared,)


def _bounces_error(case: Case, model: Model) -> float:
    """Share of the later echoes in the same pings by single rays."""
    declared = case.scene.sonar.bounces
    if model.bounces == declared or (case.scene.seabed.relief.level and not case.scene.targets):
        return 0.0
    plain = Model(case.choose_tracer(Model(bounces=declared)), rays=FEWEST_RAYS, targets=case.targets)
    return case.probe.difference(plain, plain._replace(bounces=declared))


def _say_bounces(case: Case, model: Model, error: float) -> Said | None:
    declared, reason = case.scene.sonar.bounces, "specular reflection and transmission after the first echo"
    if declared == 0:
        return None
    if case.scene.seabed.relief.level and not case.scene.targets:
        reason = "later echoes add nothing on a level bed without targets"
    elif model.bounces == 0:
        reason = f"on {case.pings} later echoes are {percent(error)} of the record"
    on = model.bounces > 0
    return Said(f"{declared} bounces", reason, on, model._replace(bounces=0 if on else declared))


def _path_of(way: str) -> Effect:
    """Row of one path by the sea surface: echoes of all paths add up, so each is measured beside the direct one."""

    def settings(case: Case, model: Model, wish: Any) -> tuple[frozenset[str], ...]:
        off = model.ways - {way}
        if way not in case.paths:
            return (off,)
        if way == SURFACE_ECHO and wish is None:
            return (off | {way},)  # it takes no time
        return (off, off | {way}) if wish is None else (off | {way},)

    def probes(case: Case) -> tuple[Model, ...]:
        direct = case.whole._replace(planes=case.path_planes)
        return (direct, direct._replace(ways=frozenset({way}))) if way in case.measured_paths else ()

    def error(case: Case, model: Model) -> float:
        if way in model.ways or way not in case.measured_paths:
            return 0.0
        share = case.probe.difference(*probes(case))
        return share * math.sqrt(len(case.measured_paths - model.ways))  # energies add up, errors by squares

    def say(case: Case, model: Model, missed: float) -> Said | None:
        if way not in case.first_echoes:
            return None
        surface, modelled = case.scene.water.surface, way in model.ways
        reason = "from image sources above the surface; objects higher than the sonar do not block the path"
        if modelled and surface.rms_height > 0.0:
            slope = math.degrees(math.sqrt(surface.slope_variance))
            reason = f"from image sources above the surface; waves of {surface.rms_height:.2g} m rms and slopes of "
            reason += f"{slope:.2g}° rms spread the echo in range"
        elif not modelled:
            first, reach = case.first_echoes[way], case.scene.sonar.range
            reason = f"its first echo arrives at {first:.3g} m, beyond the range of {reach:g} m"
            if way in case.forced:
                reason = "left out by the user"
            elif way in case.audible:
                reason = f"on {case.pings} {percent(missed)} of the record"
        return Said(
            f"{surface.kind} sea, {way.replace('_', '-')}", reason, modelled, model._replace(ways=model.ways ^ {way})
        )

    return Effect(way, "ways", settings, say, error, probes=probes)


def _planes_probes(case: Case) -> tuple[Model, ...]:
    needed = case.scene.sonar.beam.has_width and (case.targets or not case.is_level)
    return _planes_probed(case, OF_A_TARGET if case.targets else 0) if needed else ()


def remark(case: Case, model: Model) -> Iterator[PlanEntry]:
    """Entries that inform and leave no choice: precision, coherent speckle, motion of the fish, distance of pings."""
    scene, rounding = case.scene, find_tracer(model.method).rounding
    if rounding > 0.0:
        reason = "heights and strengths are rounded to 7 digits, times and sums to 16"
        yield PlanEntry("precision", "7 and 16 digits", reason, error=rounding)
    else:
        yield PlanEntry("precision", "16 digits", "rays are rounded to 16 digits")
    if scene.receiver.speckle.interferes:
        reason = "coherent speckle sums all scatterers in the beam, which takes most of the time"
        yield PlanEntry("speckle", "scatterers", reason, cost=case.seconds_of_waves(model))
    if scene.track.kinds:
        reason = "each ping has its own position and heading; the sonar does not move during a ping"
        yield PlanEntry("motion", ", ".join(scene.track.kinds), reason)
    apart = scene.track.speed / scene.sonar.ping_rate
    if not scene.sonar.beam.has_width:
        reason = f"{apart:.3g} m apart; a knife-edge beam misses anything between two pings"
        yield PlanEntry("pings", "pings", reason)
        return
    # At shorter range the beam is narrower than the distance between pings; nothing lies nearer than the bed.
    covered = apart / (2.0 * math.sin(case.packed.arrays.half_width))
    if covered > scene.altitude:
        nearer = f"up to {covered:.3g} m" if covered < scene.sonar.range else "at every range"
        reason = f"{apart:.3g} m apart, wider than the beam {nearer}, where a narrow target can be missed"
        yield PlanEntry("pings", "pings", reason)


LADDERS: tuple[tuple[str, tuple[str, ...], tuple[float, float]], ...] = (
    ("rays", ("1000", "4000", "16000", "64000"), (1, 1 << 22)),
    ("step", ("0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"), (1e-6, 1e4)),
    ("fineness", ("16", "64", "256", "1024"), (1, 1 << 30)),
)
# In the order of a plan.
ROWS = (
    Effect("method", "method", _methods, _say_method, offered=list_methods()[1:]),
    Effect("planes", "planes", _planes, _say_planes, planes_error, OF_PLANES,
           offered=("2", "4", "8", "16", "32", "64"), bounds=(1, 512), probes=_planes_probes),
    Effect("target_planes", "across", _across, _say_across, offered=("0", "4", "8", "16"), bounds=(0, 64)),
    *(Effect(field, field, _ladder_of(field), _say_ladder(field), _ladder_error(field), OF_PLANES, offered, bounds)
      for field, offered, bounds in LADDERS),
    Effect("segments", "misplaced", _segments, _say_segments, _segments_error,
           offered=("whole", "0.03", "0.01", "0.003"), closed=_segments_closed, probes=_segments_probes),
    Effect("spacing", "every", _spacing, _say_spacing, _spacing_error,
           offered=("1", "2", "4", "8"), bounds=(1, 64), closed=_spacing_closed),
    Effect("bending", "bent", _bending, _say_bending, _bending_error, closed=_bending_closed, probes=_bending_probes),
    Effect("targets", "targets", _near_targets, _say_targets(lambda case: case.near, "")),
    Effect("far_targets", "targets", _far_targets, _say_targets(_far, " out of reach")),
    *(_path_of(way) for way in WAYS),
    Effect("bounces", "bounces", _bounces, _say_bounces, _bounces_error),
)  # fmt: skip
BY_SUBJECT = {row.subject: row for row in ROWS}
