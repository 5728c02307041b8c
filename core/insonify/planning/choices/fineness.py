"""Choices of the tracer and its fineness: planes, rays, steps, segments and nodes of the relief."""

import math
from collections.abc import Iterator

from insonify.kernels.sweep.plane_errors import LEAST_PLANES
from insonify.packing.packed_scene import Model
from insonify.planning.choices.base import (
    FEWEST_RAYS,
    FINENESS,
    GRID,
    TRACER,
    Case,
    Choice,
    Doublings,
    Number,
)
from insonify.planning.choices.effects import SMALL_EFFECTS
from insonify.planning.plan_entries import PlanEntry, percent
from insonify.planning.probe import FEW_PLANES, MANY_PLANES, MEASURED, PlaneLaw
from insonify.scene import SceneError
from insonify.tracers.base import AUTO, Ladder, find_tracer, list_methods
from insonify.tracers.plane_counts import COUNTS

OF_A_TARGET = 4  # planes across each target and each glint, where a ping has no more of all
# Rays per side of the sweep's pings with several eigenrays or none; each number is judged by the next.
RAYS_STEP, FOLDED_RAYS = 4, (4000, 16_000, 64_000)
PINGS_OF_MOST_RAYS = 4  # pings traced with the most of them, a second of one core at the longest ranges
STRIDES, FEWEST_CELLS = (1, 2, 4, 8, 16, 32), 8  # of nodes; cells that a period of the bed keeps
OF_LEVEL_BED = 30.0  # weight of errors of coarser nodes over a level bed: its record has a closed form
NEARER = 1.0 / 3.0  # weight of the error over all bins, the strong ones near nadir too: three times the tolerance
LITTLE_MISPLACED = 0.002  # error of whole segments below which no division of them is measured
BESIDE_EFFECTS = 0.05  # errors of effects beside which errors of fineness are measured


class Method(Choice):
    """The tracer."""

    subject, field, stage, rank = "method", "method", TRACER, 0

    @property
    def offered(self) -> tuple[str, ...]:  # type: ignore[override]
        """The tracers."""
        return list_methods()[1:]

    def parse(self, text: str) -> str:
        """Read a forced method."""
        if text != AUTO:
            find_tracer(text)
        return text

    def settings(self, case: Case, model: Model) -> tuple[str, ...]:
        """Return the requested method, otherwise the first that can trace the scene."""
        return (case.choose_tracer(model) if case.requested == AUTO else case.requested,)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the tracer, with the time of its simplest use."""
        if case.requested != AUTO:
            reason = "as requested"
        elif model.bounces > 0:
            reason = f"{model.bounces} bounces require single rays"
        elif model.method != case.choose_tracer(Model()):
            reason = "the sound speed varies along the range, which requires single rays"
        else:
            reason = "a height field and first echoes do not require single rays"
        plain = model._replace(planes=1, bent=False, bounces=0, targets=(), ways=frozenset())
        options = () if case.scene.receiver.speckle.interferes else self.offered
        cost = case.probe.seconds(plain)
        yield self.entry(case, model.method, reason, error=error, cost=cost, options=options)


class Planes(Number):
    """Planes across the beam by which every ping begins; a ping of too great an error has more."""

    subject, field, stage, rank, high = "planes", "planes", FINENESS, 1, 512
    offered = ("2", "4", "8", "16", "32", "64")

    def settings(self, case: Case, model: Model) -> tuple[int, ...]:
        """Return the numbers of planes; one for a beam without width, and over a bed that is alike along the beam."""
        if not (self.applies(model) and case.scene.sonar.beam.has_width):
            return (1,)
        wish = self.wish(case)
        if wish is not None:
            return (wish,)
        if case.is_level and not case.scene.receiver.speckle.interferes:
            return (1,)
        # A single plane stands for a whole beam over a level bed, but for borders of its materials.
        single = (1,) if case.scene.seabed.relief.level and not case.scene.receiver.speckle.interferes else ()
        return single + tuple(count for count in COUNTS if count >= LEAST_PLANES)

    def law(self, case: Case, model: Model) -> PlaneLaw:
        """Errors by the number of planes, beside the least of other settings."""
        return case.probe.measure_planes(_swept(case)._replace(across=model.across))

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error of a number of planes by the law that is measured; none for a beam without width."""
        if self.wish(case) is None:
            if self.settings(case, model) == (1,):
                return 0.0
            if model.planes == 1:
                return self.single_error(case, model)
        return self.law(case, model).of(model.planes)

    def single_error(self, case: Case, model: Model) -> float:
        """Error of one plane over a level bed of several materials, which pings do not measure themselves."""
        coarse = _swept(case)._replace(across=model.across)
        return case.probe.difference(coarse, coarse._replace(planes=MANY_PLANES), nearer=1.0, cautious=True)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the planes, with the time beyond that of one."""
        if not self.applies(model):
            return
        if not case.scene.sonar.beam.has_width:
            yield self.entry(case, "1 plane", "a knife-edge beam has no width")
            return
        if error == 0.0:
            reason = "a level bed of one material is alike across the beam; a ping that meets a target has several"
        elif model.planes == 1 and self.wish(case) is None:
            reason = f"on a level bed, 1 and {MANY_PLANES} planes differ by {percent(error)} on {case.pings(model)}"
        else:
            few = percent(self.law(case, model).error)
            reason = (
                f"{FEW_PLANES} and {MANY_PLANES} planes differ by {few} on {MEASURED} pings; estimated error with "
                f"{model.planes}: {percent(error)}"
            )
            if self.wish(case) is None:
                reason += "; a ping of a greater error than the tolerance has more"
        alike = model._replace(across=0)
        cost = case.probe.seconds(alike) - case.probe.seconds(alike._replace(planes=1))
        choice = f"{model.planes} plane{'s' * (model.planes > 1)}"
        yield self.entry(case, choice, reason, error=error, cost=max(cost, 0.0), options=self.offered)


class TargetPlanes(Number):
    """Planes across each target in the beam and across each glint, where those of the beam are farther apart."""

    subject, field, stage, rank, low, high = "target_planes", "across", GRID, 1, 0, 64
    offered = ("0", "4", "8", "16")

    def settings(self, case: Case, model: Model) -> tuple[int, ...]:
        """Return the number of planes across a target; none without targets or for a beam without width."""
        wish = self.wish(case)
        return (OF_A_TARGET if wish is None else wish,) if self._counts(case, model) else (0,)

    def _counts(self, case: Case, model: Model) -> bool:
        return bool(self.applies(model) and case.scene.sonar.beam.has_width and case.targets)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the planes across targets, with the time that they add to a ping on average."""
        if not self._counts(case, model):
            return
        cost = max(case.probe.seconds(model) - case.probe.seconds(model._replace(across=0)), 0.0)
        reason = "at least as many across each target in the beam and each glint, with a border at each end of a target"
        choice = f"{model.across} planes across each target"
        yield self.entry(case, choice, reason, cost=cost, options=self.offered)


class Rays(Doublings):
    """Single rays per side; of the sweep those of pings to which several eigenrays or none lead."""

    subject, field, rank, high = "rays", "rays", 2, 1 << 22
    offered = ("1000", "4000", "16000", "64000")

    def settings(self, case: Case, model: Model) -> tuple[int, ...]:
        """Numbers of rays by doublings; none for a tracer without."""
        wish, tracer = self.wish(case), find_tracer(model.method)
        if not self.applies(model) or ("planes" in tracer.fineness and not model.bent):
            return (0,)
        if wish is not None:
            return (wish,)
        if "step" in tracer.fineness:
            return (case.scene.sonar.bins,)
        if tracer.ladder is not None:
            return count_by_doublings(tracer.ladder)
        return FOLDED_RAYS if case.folds else FOLDED_RAYS[:1]

    def rung(self, case: Case, model: Model) -> int:
        """Greatest rung not finer than a model, and not so fine that to judge it takes longer than the probe may."""
        rung = super().rung(case, model)
        while rung > self.first(model) and not case.probe.affords(self.pair(case, model, rung)[1]):
            rung //= 2
        return rung

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error of single rays; with the sweep of those pings only that it leaves to rays."""
        if "planes" in find_tracer(model.method).fineness and model.bent:
            return self._folded(case, model, cautious)
        return super().error(case, model, cautious)

    def _folded(self, case: Case, model: Model, cautious: bool) -> float:
        """Error measured from the next number of rays; of more than the fewest, by the power with which it falls.

        Many rays take long, so that power is measured on the loudest pings alone: their errors count most.
        """
        fine = _single(case, model)._replace(bent=True)

        def step(rays: int, cautious: bool, of: tuple[int, ...] = ()) -> float:
            pair = (fine._replace(rays=number) for number in (rays, RAYS_STEP * rays))
            return case.probe.difference(*pair, cautious=cautious, of=of)

        fewest, more, _ = FOLDED_RAYS
        if model.rays <= fewest:
            return step(model.rays, cautious)
        first, loudest = step(fewest, cautious), case.probe.loudest(fine._replace(rays=more), PINGS_OF_MOST_RAYS)
        of = loudest if step(fewest, False, loudest) > 0.0 else ()  # none of the loudest is left to rays
        before = step(fewest, False, of)
        fall = step(more, False, of) / before if before > 0.0 else RAYS_STEP**-0.5
        beyond = 1.0 if model.rays < FOLDED_RAYS[-1] else min(max(fall, 1.0 / RAYS_STEP), RAYS_STEP**-0.5)
        return first * fall * beyond

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the rays."""
        if model.rays:
            reason = f"where several eigenrays or none reach a place, a ping is traced with {model.rays} rays per side"
            if self.leads(model):
                reason = self.measured(case, model, "rays per side", error)
            yield self.entry(case, f"{model.rays} rays", reason, error=error, options=self.offered)


class Step(Number):
    """Steps of the march, with rays as dense."""

    subject, field, stage, rank, whole = "step", "step", FINENESS, 3, False
    low, high = 1e-6, 1e4
    offered = ("0.02", "0.05", "0.1", "0.2", "0.5", "1", "2")

    def settings(self, case: Case, model: Model) -> tuple[float, ...]:
        """Return steps of a cell, its half, a quarter and so on."""
        if not self.applies(model):
            return (0.0,)
        wish, spacing = self.wish(case), case.packed.arrays.bed.spacing
        return tuple(spacing / 2**n for n in range(7)) if wish is None else (wish,)

    def pair(self, case: Case, model: Model, step: float) -> tuple[Model, Model]:
        """March of a step, and that of half the step and twice the rays by which it is judged."""
        plain = Model(model.method, bent=case.bent, bounces=model.bounces, targets=case.targets, ways=case.paths)
        return plain._replace(step=step, rays=model.rays), plain._replace(step=0.5 * step, rays=2 * model.rays)

    def measured_step(self, case: Case, model: Model) -> float:
        """Step that is measured: a model's, doubled until the probe affords to judge it, no longer than the range."""
        step, longest = model.step, case.scene.sonar.range
        while 2.0 * step <= longest and not case.probe.affords(self.pair(case, model, step)[1]):
            step *= 2.0
        return step

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error measured from half the step; that of a shorter one falls with the power, of 0 to 1, last measured.

        The power is 0 where the number of rays alone keeps the error from falling.
        """
        if not self.applies(model):
            return 0.0
        step = self.measured_step(case, model)
        error = case.probe.difference(*self.pair(case, model, step), cautious=cautious)
        if step == model.step or error == 0.0:
            return error
        before = case.probe.difference(*self.pair(case, model, 2.0 * step), cautious=cautious)
        return float(error * (model.step / step) ** min(max(math.log2(max(before / error, 1.0)), 0.0), 1.0))

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the step."""
        if self.applies(model):
            step = self.measured_step(case, model)
            pair = self.pair(case, model, step)
            difference = f"steps of {step:.3g} m and of half that with twice the rays differ by "
            difference += f"{percent(case.probe.difference(*pair))} on {case.pings(pair[1])}"
            if step > model.step:
                difference = f"estimated error with steps of {model.step:.3g} m: {percent(error)} ({difference})"
            reason = f"{model.rays} rays per side; {difference}; the march can step over anything thinner than a step"
            yield self.entry(case, f"steps of {model.step:.3g} m", reason, error=error, options=self.offered)


class Fineness(Doublings):
    """What a tracer of its own counts."""

    subject, field, rank, high = "fineness", "fineness", 3, 1 << 30
    offered = ("16", "64", "256", "1024")

    def settings(self, case: Case, model: Model) -> tuple[int, ...]:
        """Numbers of the tracer's ladder; 0 for a tracer without."""
        ladder, wish = find_tracer(model.method).ladder, self.wish(case)
        if not self.applies(model) or ladder is None:
            return (0,)
        return count_by_doublings(ladder) if wish is None else (wish,)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the number."""
        ladder = find_tracer(model.method).ladder
        if self.applies(model) and ladder is not None:
            reason = self.measured(case, model, ladder.counted, error)
            yield self.entry(case, f"{model.fineness} {ladder.counted}", reason, error=error, options=self.offered)


def count_by_doublings(ladder: Ladder) -> tuple[int, ...]:
    """Return the numbers of a ladder."""
    return tuple(ladder.first << n for n in range((ladder.last // ladder.first).bit_length()))


class Segments(Choice):
    """Division of the segments of the bed's profile: the share of a bin's echo that each may misplace."""

    subject, field, stage, rank = "segments", "misplaced", GRID, 4
    offered = ("whole", "0.03", "0.01", "0.003")

    def parse(self, text: str) -> float:
        """Read a forced share."""
        super().parse(text)
        return math.inf if text == "whole" else float(text)

    def settings(self, case: Case, model: Model) -> tuple[float, ...]:
        """Return the shares offered; whole segments where none are swept."""
        wish = self.wish(case)
        if not self.applies(model):
            return (math.inf,)
        return tuple(self.parse(text) for text in self.offered) if wish is None else (wish,)

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error measured from the smallest share, by the least planes."""
        if not self.applies(model):
            return 0.0
        fine = _single(case, model)._replace(misplaced=float(self.offered[-1]))
        whole = fine._replace(misplaced=math.inf)
        little = case.probe.difference(whole, fine, nearer=NEARER) < LITTLE_MISPLACED
        # All shares between are closer still.
        coarse = whole if little else fine._replace(misplaced=model.misplaced)
        return case.probe.difference(coarse, fine, nearer=NEARER * cautious, cautious=cautious)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the segments, with the time beyond that of whole ones."""
        if not self.applies(model):
            return
        whole = model._replace(misplaced=math.inf)
        share = percent(model.misplaced)
        choice = f"segments divided to {share} of a bin's echo" if model != whole else "whole segments of the bed"
        reason = f"one angle of incidence{' for' if model == whole else ', which varies within'} each cell of the bed"
        if model.misplaced > float(self.offered[-1]):
            reason += f"; on {case.pings(_single(case, model))} {percent(error)} from the finest division"
        cost = max(case.probe.seconds(model) - case.probe.seconds(whole), 0.0)
        yield self.entry(case, choice, reason, error=error, cost=cost, options=self.offered)


class Spacing(Number):
    """Stride of the nodes of the relief that are kept."""

    subject, field, stage, rank, high = "spacing", "every", GRID, 4, 64
    offered = ("1", "2", "4", "8")

    def settings(self, case: Case, model: Model) -> tuple[int, ...]:
        """Strides that divide the period of the bed; every node of a measured bed, which is not alike everywhere."""
        seabed, wish = case.scene.seabed, self.wish(case)
        if wish is not None:
            cells = {round(part.period / seabed.spacing) for part in seabed.random_reliefs if not part.endless}
            if any(count % wish for count in cells):
                raise SceneError(
                    f"model spacing: '{wish}' does not divide the {min(cells)} cells after which the bed repeats; "
                    "give a number that does, such as 1"
                )
            return (wish,)
        return self._fitting(case, model)

    def _fitting(self, case: Case, model: Model) -> tuple[int, ...]:
        """Strides that a scene admits, whether or not one is forced, coarsest first."""
        seabed = case.scene.seabed
        # To make endless ground anew for each stride takes far longer than to trace all of its nodes.
        if not (seabed.random_reliefs or seabed.relief.level) or seabed.endless or not self.applies(model):
            return (1,)
        cells = {round(part.period / seabed.spacing) for part in seabed.random_reliefs if not part.endless}
        return tuple(n for n in STRIDES[::-1] if n == 1 or all(c % n == 0 and c >= FEWEST_CELLS * n for c in cells))

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Greatest error of the strides up to a model's by few planes; if forced or not cautious, that of its own."""
        return self._error(case, model, cautious=cautious, alone=self.subject in case.forced)

    def _error(self, case: Case, model: Model, *, cautious: bool, alone: bool) -> float:
        """Error of a stride alone, or the greatest of those up to it, weighted over a level bed."""
        fine = _single(case, model)
        if not cautious:
            return case.probe.difference(fine._replace(every=model.every), fine)
        coarse = [model.every] if alone else [2**n for n in range(1, int(math.log2(model.every)) + 1)]
        weight = OF_LEVEL_BED if case.scene.seabed.relief.level and not alone else 1.0
        pairs = ((fine._replace(every=every), fine) for every in coarse)
        return weight * max((case.probe.difference(*pair, nearer=NEARER, cautious=True) for pair in pairs), default=0.0)

    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entry of the nodes."""
        spacing = case.scene.seabed.spacing
        if model.every == 1:
            yield self.entry(case, "every node of the relief", f"{spacing:.3g} m apart", options=self.offered)
            return
        measured = f"on {case.pings(_single(case, model))} {percent(error)}"
        reason = f"{model.every * spacing:.3g} m apart instead of {spacing:.3g} m; {measured}"
        saved = max(case.probe.seconds(model._replace(every=1)) - case.probe.seconds(model), 0.0)
        choice = f"detail between every {model.every} nodes of the relief"
        yield self.entry(case, choice, reason, modelled=False, error=error, cost=saved, options=self.offered)


def _single(case: Case, model: Model) -> Model:
    """Model of the least planes, few rays and all nodes, and of all effects; swept, of those that err by no little."""
    if Planes().applies(model):
        return _swept(case)
    return Model(
        model.method,
        rays=FEWEST_RAYS,
        fineness=model.fineness,
        bent=case.bent,
        bounces=model.bounces,
        targets=case.targets,
        ways=case.paths,
    )


def _swept(case: Case) -> Model:
    """Swept model without the effects that err by little, beside which errors of fineness are measured."""
    if case.swept is None:
        made = Model(bent=case.bent, targets=case.targets, ways=case.paths)
        for choice in SMALL_EFFECTS:
            models = [made._replace(**{choice.field: value}) for value in choice.settings(case, made)]
            made = next((one for one in models if choice.error(case, one) < BESIDE_EFFECTS), models[-1])
        planes = case.least_planes if made.ways else 1
        case.swept = made._replace(planes=planes, rays=FEWEST_RAYS if made.bent else 0)
    return case.swept


CHOICES: tuple[Choice, ...] = (Method(), Planes(), TargetPlanes(), Rays(), Step(), Fineness(), Segments(), Spacing())
