"""Base of all choices of a plan, and the scene that they decide about."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar

from insonify.acoustics.water import bound_straight_rays
from insonify.errors import located
from insonify.packing.packed_scene import Model, PackedScene
from insonify.planning.plan_entries import PlanEntry, percent
from insonify.planning.probe import Probe, add_loud_pings, work_of
from insonify.planning.probe_pings import choose_probe_pings
from insonify.scene import Scene, SceneError, edit
from insonify.scene.targets.shape import Outline
from insonify.scene.water.surfaces import WAYS
from insonify.tracers.base import AUTO, find_tracer, list_methods

SWITCH = ("on", "off")
EFFECT, TRACER, GRID, FINENESS = range(4)  # stages in which choices are made
FEW_PLANES, FEWEST_RAYS = 4, 1000  # rays per side; enough to compare effects in the same pings
NEGLIGIBLE = 1e-4  # bound on the error of straight rays below which it is not measured
FARTHER = 1.1  # bound on how much farther refracted sound travels in the time of a slant range
HIGHEST = 5.0  # bound on heights of waves, in rms heights
OTHER_TILES = 2.0  # bound on the heights of endless ground, in those of the tile at the start


@dataclass(eq=False)
class Case:
    """A scene that is planned, with the requested method and the forced choices by their subjects."""

    packed: PackedScene
    requested: str
    forced: Mapping[str, str]
    swept: Model | None = None  # beside which errors of fineness are measured, once it is known
    _of_waves: dict[Model, float] = field(default_factory=dict, repr=False)

    @property
    def scene(self) -> Scene:
        """Its declaration."""
        return self.packed.scene

    @cached_property
    def near(self) -> tuple[int, ...]:
        """Indices of the targets within reach of the track, as if it had no end; all where it is not straight."""
        scene, track = self.scene, self.scene.track
        numbers = range(len(scene.targets))
        if not all(motion.keeps_line for motion in track.motions):
            return tuple(numbers)
        reach = FARTHER * scene.sonar.range + sum(motion.greatest_sway for motion in track.motions)
        c, s = math.cos(math.radians(track.heading)), math.sin(math.radians(track.heading))

        def distance(number: int) -> float:
            x, y = (scene.targets[number].position[axis] - track.start[axis] for axis in (0, 1))
            return math.hypot(min(x * c + y * s, 0.0), y * c - x * s)

        return tuple(number for number in numbers if distance(number) <= reach + self._outline(number).radius)

    def _outline(self, number: int) -> Outline:
        """Outline of a target; an error in its mesh names it."""
        with located(f"targets.{number}."):
            return self.scene.targets[number].outline

    @property
    def targets(self) -> tuple[int, ...]:
        """Indices of the targets of the finest model: those within reach, unless the user leaves them out."""
        return () if self.forced.get("targets") == "off" else self.near

    @cached_property
    def probe(self) -> Probe:
        """Its probe, made on first use."""
        packed = self.packed
        if self.scene.receiver.speckle.interferes:
            # Errors are those of the mean energy; interfering waves differ at random.
            packed = replace(packed, scene=edit(self.scene, {"receiver.speckle": "none"}))
        pings = choose_probe_pings(self.scene, packed.ground, self.targets, packed.arrays.half_width)
        probe = Probe(packed, add_loud_pings(packed, pings))
        if self.targets:
            probe.leave_out_collisions(Model(targets=self.targets))
        return probe

    def work(self, model: Model) -> float:
        """Work of a ping by a model, both sides."""
        return work_of(self.packed, model)

    def seconds(self, model: Model) -> float:
        """Seconds of a ping by a model, both sides, on one thread."""
        return self.probe.seconds(model) + self.seconds_of_waves(model)

    def seconds_of_waves(self, model: Model) -> float:
        """Seconds that coherent speckle adds to a ping, measured on one: its work is not that of the sweep."""
        if not self.scene.receiver.speckle.interferes:
            return 0.0
        if model not in self._of_waves:
            whole = self.probe.seconds_of_first(self.packed, model)
            self._of_waves[model] = max(whole - self.probe.seconds(model), 0.0)
        return self._of_waves[model]

    @cached_property
    def straight_bound(self) -> float:
        """Bound on the error of straight rays; 0 where the sound speed is the same everywhere."""
        return bound_straight_rays(self.scene) if self.packed.arrays.water.bent else 0.0

    @cached_property
    def bent(self) -> bool:
        """Whether the other errors are measured with refraction: where it may matter and can be simulated."""
        wanted = {"on": True, "off": False}.get(self.forced.get("bending", ""), self.straight_bound >= NEGLIGIBLE)
        if not (wanted and self.packed.arrays.water.bent):
            return False
        try:
            self.check_refraction()
        except SceneError:
            return False
        return True

    def check_refraction(self) -> None:
        """Raise an error if water that refracts sound is combined with an effect computed along straight rays only."""
        surface, method = self.scene.water.surface, self.requested
        if self.scene.receiver.speckle.interferes:
            raise SceneError(
                "receiver.speckle: 'coherent' sums waves along straight paths, and this water refracts sound; take "
                "another speckle, or water.kind 'uniform'"
            )
        if self.scene.water.varies_along and method != AUTO and not find_tracer(method).refracts_along:
            raise SceneError(
                f"method: {method!r} refracts sound by depth only, and a 'section' varies along the range; take rays"
            )
        if surface.reflects:
            raise SceneError(
                f"water.surface: multipath ({surface.kind!r}) follows straight paths, and this water refracts sound; "
                "take the surface 'none', or water.kind 'uniform'"
            )

    @cached_property
    def folds(self) -> bool:
        """Whether the refracted sweep leaves some pings to single rays, so that their number changes the record."""
        few, more = (Model(rays=n * FEWEST_RAYS, bent=True, targets=self.targets) for n in (1, 4))
        return self.probe.difference(few, more) > 0.0

    def choose_tracer(self, model: Model) -> str:
        """Name of the first tracer that a plan may choose for a model's bounces and refraction."""
        along = model.bent and self.scene.water.varies_along
        tracers = ((name, find_tracer(name)) for name in list_methods()[1:])
        return next(
            name
            for name, tracer in tracers
            if tracer.automatic
            and (tracer.follows_bounces or model.bounces == 0)
            and (tracer.refracts_along or not along)
        )

    @property
    def is_level(self) -> bool:
        """Whether the bed is alike all along the beam, so that one plane stands for it: level and of one material."""
        bed = self.packed.arrays.bed
        return self.scene.seabed.relief.level and bool((bed.materials == bed.materials.flat[0]).all())

    @property
    def few_planes(self) -> int:
        """Planes by which effects are compared; one for beams with a pattern, which need many near nadir."""
        return FEW_PLANES if self.scene.sonar.beam.has_width and not self.packed.arrays.pattern.tabulated else 1

    @property
    def least_planes(self) -> int:
        """Planes by which effects are compared that hardly depend on them: one, which is fastest.

        Two for surface paths of a beam with a pattern: its single plane is integrated over the beam at every knot.
        """
        whole_beam = self.scene.sonar.beam.has_width and self.packed.arrays.pattern.tabulated
        return 2 if self.paths and whole_beam else 1

    @cached_property
    def first_echoes(self) -> dict[str, float]:
        """Slant range of the first echo of each path by the sea surface that the scene declares, in metres."""
        surface, altitude = self.scene.water.surface, self.scene.altitude
        depth = self.scene.seabed.depth - altitude
        first = {
            "surface_bottom": depth + altitude,
            "surface_bottom_surface": 2.0 * depth + altitude,
            "second_bottom": 2.0 * altitude + depth,
            "surface_echo": depth,
        }
        return {way: first[way] for way, is_on in zip(WAYS, surface.paths) if is_on}

    @cached_property
    def paths(self) -> frozenset[str]:
        """Paths by the sea surface of the finest model."""
        return frozenset(
            way for way in self.first_echoes if self.forced.get(way, "on" if way in self.audible else "off") == "on"
        )

    @cached_property
    def audible(self) -> frozenset[str]:
        """Paths by the sea surface with echoes that may arrive within the range."""
        scene, rise = self.scene, math.inf  # a measured bed may lie at any depth
        waves = HIGHEST * scene.water.surface.rms_height
        if not scene.seabed.relief.measured:
            rise = max(self.packed.arrays.bed.high, 0.0) * (OTHER_TILES if scene.seabed.endless else 1.0)
        rise += max((2.0 * self._outline(k).radius for k in range(len(scene.targets))), default=0.0)
        sooner = {
            "surface_bottom": rise + waves,
            "surface_bottom_surface": rise + 2.0 * waves,
            "second_bottom": 3.0 * rise + waves,
            "surface_echo": waves,
        }
        return frozenset(way for way, first in self.first_echoes.items() if first - sooner[way] <= scene.sonar.range)

    def pings(self, model: Model) -> str:
        """Return the number of pings on which a model is compared with a coarser one, in words."""
        count = self.probe.count(model)
        return f"{count} ping{'s' * (count > 1)}"


class Choice(ABC):
    """A choice of a plan."""

    subject: ClassVar[str]  # name by which it is forced
    field: ClassVar[str]  # field of the `Model` that it sets
    stage: ClassVar[int] = EFFECT  # effects are chosen first, then the tracer, the grid and the fineness
    rank: ClassVar[int]  # place of its entries in a plan
    offered: ClassVar[tuple[str, ...]] = SWITCH  # settings offered to a user

    def parse(self, text: str) -> Any:
        """Read a forced setting; raises a `SceneError` if it is not known."""
        if text not in self.offered:
            known = ", ".join(self.offered)
            raise SceneError(f"model {self.subject}: {text!r} is not known; choose one of {known}")
        return text == "on"

    @abstractmethod
    def settings(self, case: Case, model: Model) -> tuple[Any, ...]:
        """Values of the field to consider with the choices already made, coarse to fine; one if there is no choice."""

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error of a model's setting; of effects, tracer and grid whatever its fineness.

        A cautious one, by which the choice is made, is a bound, which may weigh bins nearer than 1.4 altitudes too. The
        other is the error beyond them as measured, which a plan reports.
        """
        return 0.0

    @abstractmethod
    def entries(self, case: Case, model: Model, error: float) -> Iterator[PlanEntry]:
        """Entries of the plan about it; none if it does not concern the scene."""

    def require(self, case: Case, model: Model) -> None:
        """Raise a `SceneError` if a model with its setting cannot be simulated."""
        del case, model

    def kept(self, case: Case, model: Model, last: Model) -> Any:
        """Value of another model where the scene admits it, otherwise the finest."""
        values, value = self.settings(case, model), getattr(last, self.field)
        return value if value in values else values[-1]

    def applies(self, model: Model) -> bool:
        """Whether the tracer of a model is made finer by this choice's field."""
        return self.field in find_tracer(model.method).fineness

    def wish(self, case: Case) -> Any:
        """Return the forced setting, or None."""
        return self.parse(case.forced[self.subject]) if self.subject in case.forced else None

    def entry(self, case: Case, choice: str, reason: str, **others: Any) -> PlanEntry:
        """Make an entry about this choice."""
        return PlanEntry(self.subject, choice, reason, forced=self.subject in case.forced, **others)

    def switched(
        self, case: Case, model: Model, choice: str, reason: str, off: Any, on: Any, error: float
    ) -> PlanEntry:
        """Make the entry of an effect that is modelled or left out, with the time that it takes."""
        modelled = getattr(model, self.field) == on
        pair = (model._replace(**{self.field: value}) for value in (on, off))
        whole, less = (case.probe.seconds(one) for one in pair)
        cost = max(whole - less, 0.0)
        return self.entry(case, choice, reason, modelled=modelled, error=error, cost=cost, options=SWITCH)


class Number(Choice):
    """A choice of a number within bounds."""

    low: ClassVar[float] = 1
    high: ClassVar[float]
    whole: ClassVar[bool] = True

    def parse(self, text: str) -> Any:
        """Read a forced number."""
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not self.low <= number <= self.high or (self.whole and number != int(number)):
            whole = "a whole number" if self.whole else "a number"
            raise SceneError(
                f"model {self.subject}: {text!r} is not valid; give {whole} from {self.low:g} to {self.high:g}"
            )
        return int(number) if self.whole else number


class Doublings(Number):
    """Fineness of a tracer in doublings, the error of each measured from the next."""

    stage = FINENESS

    def leads(self, model: Model) -> bool:
        """Whether the field is the main one of those that make a model's tracer finer."""
        return find_tracer(model.method).fineness[0] == self.field

    def first(self, model: Model) -> int:
        """Coarsest rung of the tracer's ladder."""
        ladder = find_tracer(model.method).ladder
        return 1 if ladder is None else ladder.first

    def pair(self, case: Case, model: Model, rung: int) -> tuple[Model, Model]:
        """Models of a rung and of the finer one by which it is judged."""
        changes: list[dict[str, Any]] = [{self.field: number} for number in (rung, 2 * rung)]
        return model._replace(**changes[0]), model._replace(**changes[1])

    def rung(self, case: Case, model: Model) -> int:
        """Greatest rung that is not finer than a model, which is measured."""
        first = self.first(model)
        return int(first * 2 ** math.floor(math.log2(max(getattr(model, self.field) / first, 1.0))))

    def error(self, case: Case, model: Model, cautious: bool = True) -> float:
        """Error of the rung below; from there it falls with the power, of 0.5 to 1, with which it fell to that rung."""
        number = getattr(model, self.field)
        if not self.leads(model) or number == 0:
            return 0.0
        rung = self.rung(case, model)
        pair, finer = self.pair(case, model, rung), max(number / rung, 1.0)
        if rung == self.first(model):
            return float(case.probe.difference(*pair, cautious=cautious) * finer**-0.5)
        coarser = self.pair(case, model, rung // 2)
        error, before = (
            case.probe.difference(*pair, before=coarser[0], cautious=cautious),
            case.probe.difference(*coarser, cautious=cautious),
        )
        fall = math.log2(max(before / error, 1.0)) if error > 0.0 else 0.0
        return float(error * finer ** -min(max(fall, 0.5), 1.0))

    def measured(self, case: Case, model: Model, words: str, error: float) -> str:
        """Reason with what was measured."""
        rung = self.rung(case, model)
        coarse, fine = self.pair(case, model, rung)
        number, finer = getattr(model, self.field), getattr(fine, self.field)
        difference = f"{rung} and {finer} {words} differ by {percent(case.probe.difference(coarse, fine))}"
        difference += f" on {case.pings(fine)}"
        if number <= rung:
            return difference
        return f"estimated error with {number} {words}: {percent(error)} ({difference})"
