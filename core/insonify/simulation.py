"""Simulation of a scene's record, step by step: scene → plan → trace → receive → Dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from numbers import Integral
from typing import Any, Literal, NamedTuple

import numpy as np

from insonify.arrays import Booleans, Dataset, Floats, Integers, Singles
from insonify.errors import PlanWarning, warn_caller
from insonify.io.record_block import RecordBlock
from insonify.io.record_schema import RECORD_ERROR
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.packed_scene import PackedScene, pack
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.parallel import count_threads, limited_threads
from insonify.planning import Plan
from insonify.planning.selection import check_request, choose_model, keep_plan
from insonify.receiver import Reception, Traced, assemble, prepare_setup, record_echoes
from insonify.receiver.levels import Crosstalk
from insonify.receiver.water_column import WaterColumn
from insonify.record.labels import Columns
from insonify.record.record_error import RecordError
from insonify.record.target_truth import TargetTruth, find_target_truth, join_target_truth
from insonify.record.variables import make_block, record_attributes
from insonify.scene import Scene, SceneError
from insonify.tow.poses import refuse_sonar_in_bed, refuse_track_off_bed, take_poses
from insonify.tracers.base import PreparedTracer, new_record, prepare_tracer
from insonify.tracers.labels import RecordLabels, trace_labels
from insonify.tracers.plane_counts import (
    TracedPings,
    empty_bin_errors,
    empty_squares,
    errors_of_sides,
    more_across,
    trace_until,
)
from insonify.tracers.sweep import Sweep, trace_measured

UNKNOWN_COST = 1e-4  # s, of a ping, where a kept plan has none
BLOCK_TIME = 0.25  # s, predicted for a block
BLOCK_BYTES = 16e6  # of a block; a stream that is written holds three
ECHO_BYTES, LABEL_BYTES = 4, 64  # of one bin with all copies
OF_TARGETS = ("target_id", "shadow", "shadow_id", "path", "target_echo")  # labels of what a record shows of targets

Truth = bool | Literal["targets"]


class PingBlock(NamedTuple):
    """Successive pings of a record."""

    pings: Integers  # (n,) their numbers
    poses: Poses  # their poses
    # ``intensity``, and labels by their names and ``bin_error`` if requested, (n, 2, bins) each; ``error`` of sides,
    # (n, 2); ``ping_error`` and ``planes``, (n,); with the last ping ``record_error`` of all of them.
    columns: Columns


@dataclass(frozen=True, eq=False, kw_only=True)
class Simulation(PackedScene):
    """A packed scene with its plan, ready to trace and receive any of its pings.

    Its `arrays` are those of the whole scene, in water without refraction if the plan leaves that out.
    """

    plan: Plan  # method and settings of the tracing
    tolerance: float  # greatest error that a ping is to have
    reduced: SceneArrays  # the scene without the effects that the plan leaves out, which is traced
    tiles: TerrainTiles  # the ground about each ping, with as many nodes as the plan keeps
    tracer: PreparedTracer  # the method that finds echoes
    reception: Reception  # the receiver, which turns echoes into the record
    threads: int | None = None  # greatest number of threads

    def intensity(self, pings: Integers) -> Singles:
        """Trace and receive pings, any numbers in any order.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers, from 0.

        Returns
        -------
        (n, 2, bins) float32
            Linear intensity, port first; each ping is a function of the scene and its number alone.
        """
        return self.trace_record(pings)[0]

    def record(self, pings: Integers, poses: Poses) -> Singles:
        """Trace and receive pings at given poses."""
        return self.trace_record(pings, poses)[0]

    def trace_record(self, pings: Integers, poses: Poses | None = None) -> tuple[Singles, Singles]:
        """Trace and receive pings, and estimate their errors of both sides together, (n,); by default on the track."""
        pings = np.ascontiguousarray(pings, dtype=np.int64)
        poses = self.poses(pings) if poses is None else poses
        refuse_sonar_in_bed(self.scene, self.ground, pings, poses)
        traced = self.trace_pings(poses)
        return self.receive(pings, poses, traced), self.errors(traced.squares.sum(axis=1))

    def receive(self, pings: Integers, poses: Poses, traced: TracedPings, out: Singles | None = None) -> Singles:
        """Receive pings that are traced at given poses, into ``out`` if it is given."""
        with limited_threads(self.threads):
            shapes, divided = self.reception.divided_by_shape, None
            if shapes is not None:
                divided = self._trace_by(traced.planes, poses, self.reduced._replace(reflectivity=shapes))
            return record_echoes(self.reception, traced.echoes, pings, divided, out)

    def trace(self, poses: Poses) -> Traced:
        """Trace echoes of an ideal pulse: their mean energy, or their waves where the receiver adds others to them."""
        return self.trace_pings(poses).echoes

    def trace_pings(self, poses: Poses, *, of_bins: bool = False) -> TracedPings:
        """Trace echoes and errors, each ping by as many planes as its error requires; errors of bins too if wanted."""
        if not self.estimates_errors:
            planes = np.full(poses.x.size, self.plan.planes, np.int64)
            nothing = empty_squares(poses.x.size), planes, empty_bin_errors(poses.x.size)
            return TracedPings(self._trace_by(planes, poses, self.reduced), *nothing)
        with limited_threads(self.threads):
            found = self.tiles.map(
                lambda tile, some: trace_measured(
                    tile, some, goal=self.plan.goal, of_bins=of_bins, **self.plan.settings
                ),
                self.reduced,
                poses,
            )
        return TracedPings(*found)

    @property
    def estimates_errors(self) -> bool:
        """Whether the planes of each ping estimate its error, as in the sweep, which sums energies."""
        return isinstance(self.tracer, Sweep)

    def _trace_by(self, planes: Integers, poses: Poses, arrays: SceneArrays) -> Traced:
        """Trace pings by given numbers of planes."""
        trace_pings = (self.reception.sums_waves and self.tracer.trace_waves) or self.tracer.trace

        def trace_tile(tile: SceneArrays, some: Poses, own: Integers) -> Traced:
            return trace_pings(tile, some, **self.settings_of(own))

        with limited_threads(self.threads):
            found: Traced = self.tiles.map(trace_tile, arrays, poses, planes)
            return found

    def settings_of(self, planes: Integers) -> dict[str, Any]:
        """Arguments of the tracer for pings of some numbers of planes."""
        if not self.estimates_errors:
            return dict(self.plan.settings)
        return _with_planes(self.plan.settings, planes, self.plan.planes)

    def errors(self, squares: Floats) -> Singles:
        """Estimated errors from their squares, (.., regions, 2): errors of planes, and of what the plan leaves out.

        Where planes give no estimate it is the error that the plan has measured; NaN in a plan that measured nothing.
        """
        by_planes = np.hypot(errors_of_sides(squares), self.plan.left_out)
        return np.where(_are_estimates(squares), by_planes, self._measured_error).astype(np.float32)

    def bin_errors(self, traced: TracedPings) -> Singles:
        """Estimated errors of the bins of pings that are traced with them, (n, 2, bins), as intensities of the record.

        Over the echo of a level bed, their squares add up to the square of the error of a side by planes.
        """
        by_planes = np.hypot(traced.bin_errors, self.plan.left_out * traced.echoes)
        is_estimate = _are_estimates(traced.squares)[..., None]
        errors = np.where(is_estimate, by_planes, self._measured_error * traced.echoes)
        return np.asarray(errors * self.reception.gain, np.float32)

    def require_bin_errors(self, wanted: bool) -> None:
        """Raise a SceneError if errors of bins are wanted that the tracer does not estimate."""
        if wanted and not self.estimates_errors:
            method = "coherent speckle" if self.plan.method == "sweep" else f"the method {self.plan.method!r}"
            remedy = "leave it out" if self.plan.method == "sweep" else "leave it out or use the method 'sweep'"
            raise SceneError(f"bin_error: {method} gives no estimate of the error of bins; {remedy}")

    @property
    def _measured_error(self) -> float:
        """Error that the plan has measured; NaN if it measured nothing."""
        return self.plan.error if self.plan.entries else np.nan

    def expect(self, pings: Integers) -> None:
        """Keep the ground beneath pings, (n,) numbers, that are traced again in any blocks, if memory allows."""
        self.tiles.expect(self.poses(np.asarray(pings, dtype=np.int64)))

    def truth(self, pings: Integers) -> RecordLabels:
        """Label every range bin of the given pings.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers, from 0.

        Returns
        -------
        RecordLabels
            Arrays (n, 2, bins), port first. It comes from the geometry of the sweep for every method, with an ideal
            pulse: a longer one carries each echo on into the bins that follow.
        """
        pings = np.asarray(pings, dtype=np.int64)
        return self.labels(self.poses(pings))[0]

    def labels(
        self, poses: Poses, *, traced: bool = False, targets_alone: bool = False
    ) -> tuple[RecordLabels, TracedPings]:
        """Label every range bin of pings at given poses, as `truth` does; return the echoes too if they are traced.

        With ``targets_alone`` pings that show the bed alone are not labelled with its places.
        """
        water, crosstalk = self.reception.find(WaterColumn), self.reception.find(Crosstalk)
        settings: dict[str, Any] = self.plan.label_settings | {"targets_alone": targets_alone and self._shows_bed}
        settings["crosstalk"], first = 0.0 if crosstalk is None else crosstalk.share, settings.get("planes", 16)
        goal = self.plan.goal if self.estimates_errors else None
        settings |= {} if goal is None else {"trust": goal.trust}

        def label_tile(tile: SceneArrays, some: Poses, counts: Integers) -> tuple[Any, ...]:
            volumes = water.volumes.energies(some) if water is not None and water.volumes is not None else None
            echoes, squares = new_record(tile, some) if traced else None, empty_squares(some.x.size)
            own = _with_planes(settings, counts, first)
            labels = trace_labels(tile, some, volumes=volumes, echoes=echoes, squares=squares, **own)
            return (*labels, squares if echoes is None else echoes, squares)

        def label_some(places: Integers, counts: Integers) -> tuple[Any, ...]:
            found: tuple[Any, ...] = self.tiles.map(label_tile, self.reduced, take_poses(poses, places), counts)
            return found

        with limited_threads(self.threads):
            (*labels, echoes, squares), planes = trace_until(goal, first, poses.x.size, label_some)
        return RecordLabels(*labels), TracedPings(echoes, squares, planes, empty_bin_errors(poses.x.size))

    def pings_within(self, seconds: float) -> int:
        """Return the number of pings that take about so long by the plan's cost, at least 1."""
        with limited_threads(self.threads):
            return max(1, int(seconds * count_threads() / (self.plan.cost or UNKNOWN_COST)))

    def record_blocks(
        self, truth: Truth = False, block: int | None = None, pings: range | None = None, *, bin_error: bool = False
    ) -> Iterator[PingBlock]:
        """Trace and receive successive pings, or all, as many at a time as take some time and memory."""
        size, error = self._block_size(truth, streamed=True) if block is None else block, RecordError(self.tolerance)
        wanted = range(self.scene.track.pings) if pings is None else pings
        for first in range(wanted.start, wanted.stop, size):
            some = np.arange(first, min(first + size, wanted.stop), dtype=np.int64)
            poses = self.poses(some)
            columns = self._columns(some, poses, truth, bin_error=bin_error)
            error.add(some, columns["ping_error"], columns["planes"])
            if some.size and some[-1] == wanted.stop - 1:
                columns[RECORD_ERROR] = np.array(error.whole)
            yield PingBlock(some, poses, columns)
        self._warn_of(error)

    def record_whole(
        self, truth: Truth, progress: Callable[[int, int], None] | None, *, bin_error: bool = False
    ) -> PingBlock:
        """Trace and receive all pings, block by block into arrays of the record's length."""
        pings = np.arange(self.scene.track.pings, dtype=np.int64)
        size, poses, whole = self._block_size(truth, streamed=False), self.poses(pings), Columns()
        for first in range(0, pings.size, size):
            part = slice(first, min(first + size, pings.size))
            out = whole["intensity"][part] if whole else None
            found = self._columns(pings[part], take_poses(poses, part), truth, out, bin_error=bin_error)
            for name, column in found.items():
                if size >= pings.size:
                    whole[name] = column
                    continue
                if name not in whole:
                    whole[name] = np.empty((pings.size, *column.shape[1:]), column.dtype)
                if column is not out:
                    whole[name][part] = column
            if progress is not None:
                progress(part.stop, pings.size)
        error = RecordError(self.tolerance)
        error.add(pings, whole["ping_error"], whole["planes"])
        self._warn_of(error)
        whole[RECORD_ERROR] = np.array(error.whole)
        return PingBlock(pings, poses, whole)

    def _warn_of(self, error: RecordError) -> None:
        """Warn of pings beyond the tolerance, unless the plan is known to exceed it."""
        if self.plan.goal is not None and self.plan.error <= self.tolerance:
            error.warn()

    def _columns(
        self, pings: Integers, poses: Poses, truth: Truth, out: Singles | None = None, *, bin_error: bool = False
    ) -> Columns:
        """Intensity of some pings and its estimated errors, and their labels if requested."""
        refuse_sonar_in_bed(self.scene, self.ground, pings, poses)
        columns, by_labelling = Columns(), bool(truth) and self._traces_by_labelling and not bin_error
        if truth:
            alone = truth == "targets"
            labels, traced = self.labels(poses, traced=by_labelling, targets_alone=alone)
            columns = {name: getattr(labels, name) for name in (OF_TARGETS if alone else labels._fields)}
        if not by_labelling:
            traced = self.trace_pings(poses, of_bins=bin_error)
        if bin_error:
            columns["bin_error"] = self.bin_errors(traced)  # before the echoes become the record
        columns |= {"error": self.errors(traced.squares), "ping_error": self.errors(traced.squares.sum(axis=1))}
        return {"intensity": self.receive(pings, poses, traced, out), "planes": traced.planes, **columns}

    @property
    def _traces_by_labelling(self) -> bool:
        """Whether the sweep that labels finds the echoes of the record; by way of waves it takes them one by one."""
        multipath = self.reduced.multipath
        waves = multipath.enabled and (multipath.rms_height > 0.0 or multipath.slope_variance > 0.0)
        return isinstance(self.tracer, Sweep) and not waves

    @property
    def _shows_bed(self) -> bool:
        """Whether traced echoes of pings that meet no target are those of the bed, by the direct path alone."""
        others = self.reception.find(WaterColumn) or self.reception.find(Crosstalk) or self.scene.seabed.endless
        more = self.reduced.multipath.enabled or self.reduced.water.bent
        return self._traces_by_labelling and not (others or more)

    def _block_size(self, truth: Truth, *, streamed: bool) -> int:
        """Return the number of pings to trace at a time, by time and by the memory that a block takes."""
        bytes_a_ping = 2 * self.scene.sonar.bins * (ECHO_BYTES + LABEL_BYTES * bool(truth))
        fitting = int(BLOCK_BYTES / bytes_a_ping) if streamed or truth else self.scene.track.pings
        return max(1, min(fitting, self.pings_within(BLOCK_TIME)))


def _are_estimates(squares: Floats) -> Booleans:
    """Whether squares, (.., regions, 2), give an estimate of the error."""
    return (squares[..., 1].sum(axis=-1) > 0.0) & np.isfinite(errors_of_sides(squares))


def _with_planes(settings: Mapping[str, Any], planes: Integers, first: int) -> dict[str, Any]:
    """Arguments of a tracer for pings of other numbers of planes than the first."""
    across = settings.get("across", 0)
    return {**settings, "planes": planes} | ({"across": more_across(planes, first, across)} if across > 0 else {})


def prepare(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    threads: int | None = None,
    plan: Plan | None = None,
    packed: PackedScene | None = None,
) -> Simulation:
    """Build the ground of a scene, plan it and make its receiver ready.

    Parameters
    ----------
    scene, method, tolerance, forced, threads
        As in `simulate`.
    plan : Plan, optional
        A plan of this scene or of one like it, which is kept where the geometry of the scene admits it; nothing is
        measured then.
    packed : PackedScene, optional
        The scene's ground and arrays, if they exist already, made by `insonify.packing.packed_scene.pack`.

    Returns
    -------
    Simulation

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy.
    """
    wishes = forced or {}
    check_request(scene, tolerance, method, wishes)
    with limited_threads(threads):
        packed = packed or pack(scene)
        refuse_track_off_bed(scene, packed.ground)
        if plan is not None:
            plan = keep_plan(packed, plan, method, wishes)
        else:
            plan = choose_model(packed, tolerance, method, wishes)
            if plan.error > tolerance:
                warn_caller(PlanWarning(plan.describe_excess(tolerance)))
        arrays, tracer = packed.arrays_in_water(plan.model), prepare_tracer(packed, plan.model)
        return Simulation(
            packed.scene,
            packed.ground,
            arrays,
            plan=plan,
            tolerance=tolerance,
            reduced=packed.modelled_arrays(plan.model),
            tiles=packed.ground_tiles(plan.model.every, tracer.bins_beyond),
            tracer=tracer,
            reception=assemble(prepare_setup(packed.scene, packed.ground, arrays)),
            threads=threads,
        )


def simulate(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: Truth = False,
    bin_error: bool = False,
    progress: Callable[[int, int], None] | None = None,
    threads: int | None = None,
) -> Dataset:
    """Simulate a scene's whole record.

    Parameters
    ----------
    scene : Scene
        What there is.
    method : str
        ``sweep``, ``march``, ``rays``, or ``auto``.
    tolerance : float
        Greatest error beyond 1.4 times the altitude, as a share of the record. A `PlanWarning` reports an estimated
        error beyond it.
    forced : mapping of str to str, optional
        Choices that are not left to the plan, as in `insonify.plan`.
    truth : bool or "targets"
        Whether to add labels of every bin: the target, the material, shadow, ground range, incidence and path, as
        `Simulation.truth` has them. "targets" leaves out the material, ground range and incidence, and takes a fraction
        of the time: pings that meet no target are labelled by their echoes.
    bin_error : bool
        Whether to add the estimated error of every bin as ``bin_error``, in the unit of the intensity; NaN in the few
        bins before the first return of a level bed, in which planes are not compared. Only the sweep estimates it.
    progress : callable, optional
        Called with the pings done and the pings in all.
    threads : int, optional
        Greatest number of threads; all cores that the process may use, or `INSONIFY_THREADS`, when left out. The
        record does not depend on it.

    Returns
    -------
    Dataset
        Dimensions (channel, ping_time, range_sample).

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy.
    """
    request: dict[str, Any] = {"method": method, "tolerance": tolerance, "forced": forced}
    simulation = prepare(scene, **request, threads=threads)
    simulation.require_bin_errors(bin_error)
    whole = simulation.record_whole(truth, progress, bin_error=bin_error)
    found = find_target_truth(scene, whole.columns, 0) if truth else None
    attributes = record_attributes(scene, simulation.plan, **request)
    return make_block(scene, simulation.ground, *whole, found, attributes).to_dataset()


def simulate_blocks(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: Truth = False,
    bin_error: bool = False,
    block: int | None = None,
    pings: range | None = None,
    threads: int | None = None,
) -> Iterator[Dataset]:
    """Simulate a scene's record block by block, so that memory does not grow with its length.

    Parameters
    ----------
    scene, method, tolerance, forced, truth, bin_error, threads
        As in `simulate`.
    block : int, optional
        Pings at a time; the record does not depend on it. By default as many as take a quarter of a second and 16 MB.
    pings : range, optional
        Successive pings, such as those that a record still lacks; all of the track when left out.

    Returns
    -------
    iterator of Dataset
        Successive pings. Labels of a whole target describe all pings so far; the last block's labels describe the whole
        record. The bed and the plan are made for the first one.

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy: at once for the other arguments, with the first block for what
        is wrong in the scene.
    """
    request: dict[str, Any] = {"method": method, "tolerance": tolerance, "forced": forced, "threads": threads}
    request |= {"truth": truth, "bin_error": bin_error, "block": block, "pings": pings}
    return (simulated.to_dataset() for simulated in simulate_record_blocks(scene, **request))


def simulate_record_blocks(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: Truth = False,
    bin_error: bool = False,
    block: int | None = None,
    pings: range | None = None,
    threads: int | None = None,
) -> Iterator[RecordBlock]:
    """Simulate a scene's record with the parameters of `simulate_blocks`, as blocks of plain arrays."""
    if block is not None and not (isinstance(block, Integral) and block >= 1):
        raise SceneError(f"block: {block!r} is not a number of pings; give at least 1")
    count, successive = scene.track.pings, isinstance(pings, range) and pings.step == 1
    if pings is not None and not (successive and 0 <= pings.start <= pings.stop <= count):
        fault = f"{pings!r:.80} is not part of the track"
        raise SceneError(f"pings: {fault}; give a range of successive ones of its {count}")
    with limited_threads(threads):
        check_request(scene, tolerance, method, forced or {})

    def blocks() -> Iterator[RecordBlock]:
        request: dict[str, Any] = {"method": method, "tolerance": tolerance, "forced": forced}
        simulation = prepare(scene, **request, threads=threads)
        simulation.require_bin_errors(bin_error)
        attributes = record_attributes(scene, simulation.plan, **request)
        so_far: list[TargetTruth] = []
        for traced in simulation.record_blocks(truth, block, pings, bin_error=bin_error):
            if truth:
                so_far = [join_target_truth(*so_far, find_target_truth(scene, traced.columns, int(traced.pings[0])))]
            yield make_block(scene, simulation.ground, *traced, so_far[0] if truth else None, attributes)

    return blocks()
