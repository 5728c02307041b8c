"""A scene that is planned: what its geometry and closed bounds decide before any ping is traced."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from insonify.acoustics.flat_bed import ERROR_ALTITUDES
from insonify.acoustics.water import bound_straight_rays
from insonify.arrays import Floats
from insonify.errors import located
from insonify.kernels.sweep.bed_stretches import FINE
from insonify.packing.packed_scene import SURFACE_ECHO, Model, PackedScene
from insonify.planning.probe import SECONDS_OF_WORK, Probe, add_loud_pings, work_of
from insonify.planning.probe_pings import choose_probe_pings
from insonify.scene import Scene, SceneError, edit
from insonify.scene.sonar.vertical_beams import UniformVerticalBeam
from insonify.scene.targets.shape import Outline
from insonify.scene.water.surfaces import WAYS
from insonify.tracers.base import AUTO, find_tracer, list_methods

FEWEST_RAYS = 1000  # rays per side; enough to compare effects in the same pings
NEGLIGIBLE = 1e-4  # bound on the error of straight rays below which it is not measured
FARTHER = 1.1  # bound on how much farther refracted sound travels in the time of a slant range
HIGHEST = 5.0  # bound on heights of waves, in rms heights
OTHER_TILES = 2.0  # bound on the heights of endless ground, in those of the tile at the start
ROWS = 8  # of nodes, by which what lies between nodes is estimated
ALONG_GRID = 3.0  # degrees up to which a plane follows the grid
STEEPEST = math.asin(1.0 / ERROR_ALTITUDES)  # grazing angle beyond which errors count in full, rad


@dataclass(eq=False)
class Case:
    """A scene that is planned, with the requested method and the forced choices by their subjects."""

    packed: PackedScene
    requested: str
    forced: Mapping[str, str]
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
        return Probe(packed, add_loud_pings(packed, pings), self.targets)

    def work(self, model: Model) -> float:
        """Work of a ping by a model, both sides."""
        return work_of(self.packed, model)

    def seconds(self, model: Model) -> float:
        """Seconds of a ping by a model, both sides, on one thread, without waves."""
        rate = self.probe.rate(model) if "probe" in vars(self) else SECONDS_OF_WORK
        return rate * self.work(model)

    def seconds_of_waves(self, model: Model) -> float:
        """Seconds that coherent speckle adds to a ping, measured on one: its work is not that of the sweep."""
        if not self.scene.receiver.speckle.interferes:
            return 0.0
        if model not in self._of_waves:
            self._of_waves[model] = max(self.probe.seconds_of_first(self.packed, model) - self.seconds(model), 0.0)
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
        return self.bent and self.probe.folds(self.whole)

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
        """Whether the planes of a beam are alike, so that one stands for all: over a level bed of one material.

        A vertical beam ends at another range in each plane, and near nadir a beam off athwart has fewer of them.
        """
        scene, arrays = self.scene, self.packed.arrays
        is_athwart = arrays.pattern.centre == 0.0 and "pitch" not in scene.track.kinds
        is_uniform = isinstance(scene.sonar.vertical, UniformVerticalBeam)
        return scene.seabed.relief.level and not arrays.bed.mapped and is_uniform and is_athwart

    @property
    def bare(self) -> Model:
        """Swept model of one plane over the bed alone."""
        return Model(bent=self.bent, rays=FEWEST_RAYS if self.bent else 0)

    @property
    def whole(self) -> Model:
        """The same with the targets within reach."""
        return self.bare._replace(targets=self.targets)

    @property
    def path_planes(self) -> int:
        """Planes by which surface paths are compared: one, or two for a beam with a pattern.

        Its single plane is integrated over the beam at every knot.
        """
        return 2 if self.scene.sonar.beam.has_width and self.packed.arrays.pattern.tabulated else 1

    @cached_property
    def _node_rows(self) -> list[tuple[Floats, Floats]]:
        """Heights of some rows of nodes and of the rows beside them, along both axes of the grid."""
        bed = self.packed.arrays.bed
        steps = [(rows, max((len(rows) - 1) // ROWS, 1)) for rows in (bed.heights, bed.transposed)]
        return [(rows[:-1:step].astype(np.float64), rows[1::step].astype(np.float64)) for rows, step in steps]

    def slope_between(self, every: int) -> float:
        """Root mean square of the slopes that a bed loses if only every n-th node is kept, on some rows of nodes."""
        lost = []
        for some, _ in self._node_rows:
            some = some[:, : (some.shape[1] - 1) // every * every + 1]
            kept = some[:, ::every]
            share = np.arange(every) / every
            between = (kept[:, :-1, None] * (1.0 - share) + kept[:, 1:, None] * share).reshape(len(some), -1)
            lost.append(np.square(np.diff(some[:, :-1] - between, axis=1)).mean())
        return math.sqrt(max(lost)) / self.packed.arrays.bed.spacing

    @cached_property
    def whole_segments_bound(self) -> float:
        """Bound on the error of whole segments in planes along the grid, with lobes near nadir alone; else infinite.

        An eighth of the change of density from end to end of a segment: by its range, by the twist of its cell, and by
        its turn within the lobe near nadir, which counts a third. Derived in docs/theory/sweep.md.
        """
        scene, arrays = self.scene, self.packed.arrays
        askew = abs((scene.track.heading + 45.0) % 90.0 - 45.0) + math.degrees(arrays.half_width)
        turns = bool(scene.track.kinds) or arrays.pattern.centre != 0.0 or arrays.limits.angle < math.inf
        if askew > ALONG_GRID or turns or scene.seabed.relief.measured:
            return math.inf
        lobe, spacing, twist, slope = arrays.limits.shininess, arrays.bed.spacing, 0.0, 0.0
        for one, beside in self._node_rows:
            across = (beside - one) / spacing
            slope = max(slope, float(np.square(across).mean()))
            twist = max(twist, float(np.square(np.diff(across, axis=1) * across[:, 1:]).mean()))
        if lobe > 0.0 and 4.0 * math.sqrt(slope) + 2.5 / math.sqrt(2.0 * lobe) > STEEPEST:
            return math.inf
        nearest = ERROR_ALTITUDES * max(scene.altitude, spacing)
        middle = math.sqrt(nearest * max(scene.sonar.range, nearest))  # where 1/r is its root mean square
        turn = math.sqrt(lobe) * spacing / max(scene.altitude, spacing) / 3.0
        return 0.125 * (3.0 * min(spacing / middle, FINE) + 2.0 * math.sqrt(twist) + turn)

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

    @property
    def measured_paths(self) -> frozenset[str]:
        """The same without the echo of the surface itself, which is alike in all models and may outweigh the bed."""
        return self.paths - {SURFACE_ECHO}

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

    @property
    def pings(self) -> str:
        """The number of pings on which models are compared, in words."""
        count = self.probe.size
        return f"{count} ping{'s' * (count > 1)}"
