"""Simulation of a scene's record, step by step: scene → plan → trace → receive → Dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from insonify.io.record_block import RecordBlock
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.packing.packed_scene import PackedScene, pack
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.parallel import count_threads, limited_threads
from insonify.planning import Plan
from insonify.planning.selection import check_request, choose_model, keep_plan
from insonify.receiver import Reception, Traced, prepare_reception, record_echoes
from insonify.receiver.levels import Crosstalk
from insonify.receiver.water_column import WaterColumn
from insonify.record.blocks import trace_blocks, trace_whole
from insonify.record.target_truth import TargetTruth, find_target_truth, join_target_truth
from insonify.record.variables import make_block, record_attributes
from insonify.scene import Scene, SceneError
from insonify.terrain import AnyGround
from insonify.tow.line import TowLine, tow_line_at
from insonify.tow.poses import bed_beneath, make_poses, refuse_track_off_bed
from insonify.tracers.labels import RecordLabels, trace_labels
from insonify.tracers.registry import Tracer

if TYPE_CHECKING:
    import xarray as xr

UNKNOWN_COST = 1e-4  # s, of a ping, where the plan tells none

Echoes = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Simulation:
    """A scene made ready to trace any of its pings."""

    scene: Scene  # the declaration
    plan: Plan  # methods and settings of the tracing
    ground: AnyGround  # the bed
    # The whole scene as tracers take it; of endless ground only the piece at the start of the track.
    arrays: SceneArrays
    reduced: SceneArrays  # the scene without the effects that the plan omits; this one is traced
    tiles: TerrainTiles  # the ground about each ping, with as many nodes as the plan keeps
    tracer: Tracer  # the method that finds echoes
    reception: Reception  # the receiver, which turns echoes into the record
    threads: int | None = None  # greatest number of threads that work on it

    def poses(self, pings: NDArray[np.int64]) -> Poses:
        """Return position and attitude of the sonar at the given pings; beyond the track's last the tow goes on."""
        return make_poses(self.scene, self.ground, pings)

    def line(self, pings: NDArray[np.int64]) -> TowLine:
        """Return positions and headings along the line of the tow, without the motion of the fish about it."""
        return tow_line_at(self.scene, pings)

    def altitude(self, pings: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the altitude of the sonar above the bed, in metres, with the bed smoothed as a fish follows it."""
        return self.poses(pings).z - bed_beneath(self.scene, self.ground, pings)

    def intensity(self, pings: NDArray[np.int64]) -> NDArray[np.float32]:
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
        pings = np.ascontiguousarray(pings, dtype=np.int64)
        return self.record(pings, self.poses(pings))

    def record(self, pings: NDArray[np.int64], poses: Poses, out: Echoes | None = None) -> Echoes:
        """Trace and receive pings whose poses are known.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers.
        poses : Poses
            Their poses.
        out : (n, 2, bins) float32, optional
            Takes the intensity.

        Returns
        -------
        (n, 2, bins) float32
            Linear intensity, port first: ``out``, if it is given.
        """
        with limited_threads(self.threads):
            shapes, divided = self.reception.divided_by_shape, None
            traced = self.trace(poses)
            if shapes is not None:
                divided = self.trace(poses, self.reduced._replace(reflectivity=shapes))
            return record_echoes(self.reception, traced, pings, divided, out)

    def trace(self, poses: Poses, arrays: SceneArrays | None = None) -> Traced:
        """Trace echoes of an ideal pulse: their mean energy, or their waves where the receiver adds others to them."""
        trace_pings = (self.reception.sums_waves and self.tracer.trace_waves) or self.tracer.trace

        def trace_tile(tile: SceneArrays, some: Poses) -> tuple[Traced]:
            return (trace_pings(tile, some, **self.plan.settings),)

        return self.tiles.map(trace_tile, self.reduced if arrays is None else arrays, poses)[0]

    def expect(self, pings: NDArray[np.int64]) -> None:
        """Keep the ground beneath pings, (n,) numbers, that are traced again in whatever blocks, as far as it fits."""
        self.tiles.expect(self.poses(np.asarray(pings, dtype=np.int64)))

    def truth(self, pings: NDArray[np.int64]) -> RecordLabels:
        """Label every range bin of the given pings.

        Parameters
        ----------
        pings : (n,) int64
            Ping numbers, from 0.

        Returns
        -------
        RecordLabels
            Arrays (n, 2, bins), port first. It comes from the geometry of the sweep whatever the method, and is that
            of an ideal pulse: a longer one carries each echo on into the bins that follow.
        """
        pings = np.asarray(pings, dtype=np.int64)
        return self.labels(self.poses(pings))

    def labels(self, poses: Poses) -> RecordLabels:
        """Label every range bin of pings whose poses are known, as `truth` does."""
        settings = {name: number for name, number in self.plan.settings.items() if name in ("planes", "rays")}
        water, crosstalk = self.reception.find(WaterColumn), self.reception.find(Crosstalk)
        share = 0.0 if crosstalk is None else crosstalk.share

        def label_tile(tile: SceneArrays, some: Poses) -> RecordLabels:
            volumes = water.volumes.energies(some) if water is not None and water.volumes is not None else None
            return trace_labels(tile, some, crosstalk=share, volumes=volumes, **settings)

        with limited_threads(self.threads):
            return RecordLabels(*self.tiles.map(label_tile, self.reduced, poses))

    def pings_within(self, seconds: float) -> int:
        """Return the number of pings that take about so long by the plan's cost, at least 1."""
        with limited_threads(self.threads):
            return max(1, int(seconds * count_threads() / (self.plan.cost or UNKNOWN_COST)))


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
        A plan of this scene or of one like it, which is kept as far as the geometry of the scene admits it; nothing is
        measured then.
    packed : PackedScene, optional
        The scene's ground and arrays, if they are made already, as by `insonify.packing.packed_scene.pack`.

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
        if plan is None:
            return _prepare(packed, choose_model(packed, tolerance, method, wishes), threads)
        return _prepare(packed, keep_plan(packed, plan, method, wishes), threads)


def _prepare(packed: PackedScene, plan: Plan, threads: int | None) -> Simulation:
    """Make a planned scene ready to be traced."""
    reduced = packed.reduced(plan.model)
    return Simulation(
        scene=packed.scene,
        plan=plan,
        ground=packed.ground,
        arrays=reduced.whole,
        reduced=reduced.arrays,
        tiles=reduced.tiles,
        tracer=reduced.tracer,
        reception=prepare_reception(packed.scene, packed.ground, reduced.whole),
        threads=threads,
    )


def simulate(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: bool = False,
    progress: Callable[[int, int], None] | None = None,
    threads: int | None = None,
) -> xr.Dataset:
    """Simulate a scene's whole record.

    Parameters
    ----------
    scene : Scene
        What there is.
    method : str
        ``sweep``, ``march``, ``rays``, or ``auto``.
    tolerance : float
        Greatest error beyond 1.4 times the altitude, as a share of the record.
    forced : mapping of str to str, optional
        Choices that are not left to the plan, as in `insonify.plan`.
    truth : bool
        Whether to add labels of every bin: the target, the material, shadow, ground range, incidence and path, as
        `Simulation.truth` has them.
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
    asked: dict[str, Any] = {"method": method, "tolerance": tolerance, "forced": forced}
    simulation = prepare(scene, **asked, threads=threads)
    pings = np.arange(scene.track.pings, dtype=np.int64)
    poses = simulation.poses(pings)
    columns = trace_whole(simulation, pings, poses, truth, progress)
    found = find_target_truth(scene, columns, 0) if truth else None
    attributes = record_attributes(scene, simulation.plan, **asked)
    return make_block(scene, simulation.ground, pings, poses, columns, found, attributes).to_dataset()


def simulate_blocks(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: bool = False,
    block: int | None = None,
    pings: range | None = None,
    threads: int | None = None,
) -> Iterator[xr.Dataset]:
    """Simulate a scene's record block by block, so that memory does not grow with its length.

    Parameters
    ----------
    scene, method, tolerance, forced, truth, threads
        As in `simulate`.
    block : int, optional
        Pings at a time, on which the record does not depend; else as many as take a quarter of a second and 16 MB.
    pings : range, optional
        Successive pings, such as those that a record still lacks; all of the track when left out.

    Yields
    ------
    Dataset
        Successive pings. What ``truth`` tells of each target is that of all pings so far; the last block tells that of
        the whole record.

    Raises
    ------
    SceneError
        One sentence with what is wrong and the remedy.
    """
    asked: dict[str, Any] = {"method": method, "tolerance": tolerance, "forced": forced, "threads": threads}
    for simulated in simulate_record_blocks(scene, **asked, truth=truth, block=block, pings=pings):
        yield simulated.to_dataset()


def simulate_record_blocks(
    scene: Scene,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
    truth: bool = False,
    block: int | None = None,
    pings: range | None = None,
    threads: int | None = None,
) -> Iterator[RecordBlock]:
    """Simulate a scene's record as `simulate_blocks` does, whose parameters these are, without Datasets."""
    if block is not None and block < 1:
        raise SceneError(f"block: {block} pings at a time are none; give at least 1")
    asked: dict[str, Any] = {"method": method, "tolerance": tolerance, "forced": forced}
    if pings is not None and not (pings.step == 1 and 0 <= pings.start <= pings.stop <= scene.track.pings):
        raise SceneError(f"pings: {pings} is not of the track; give successive ones of its {scene.track.pings}")
    simulation = prepare(scene, **asked, threads=threads)
    attributes = record_attributes(scene, simulation.plan, **asked)
    so_far: list[TargetTruth] = []
    for traced in trace_blocks(simulation, truth, block, pings):
        if truth:
            so_far = [join_target_truth(*so_far, find_target_truth(scene, traced.columns, int(traced.pings[0])))]
        yield make_block(scene, simulation.ground, *traced, so_far[0] if truth else None, attributes)
