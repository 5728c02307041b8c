"""Speed against accuracy of every method on one scene, measured from start to end on this machine."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import thread_time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy.charts.contenders import EMBREE, EMBREE_OWN, Contender, Name, contenders
from insonify.accuracy.charts.embree import TriangulatedBed, why_not
from insonify.accuracy.charts.machine import machine
from insonify.accuracy.charts.reference import Reference, prove
from insonify.accuracy.metrics import Displacement, Errors, compare, displacement, flat_bed_curves, time_calls
from insonify.display.picture import held_curve, normalise
from insonify.kernels.common.types import Poses, SceneArrays, still_water
from insonify.packing.navigation import make_poses, take_poses
from insonify.packing.scene_arrays import pack_scene
from insonify.packing.terrain_tiles import TerrainTiles
from insonify.scene import Scene, SceneError, edit
from insonify.simulation import prepare
from insonify.terrain import build_ground

PINGS = 8
AS_NEAR = 0.02  # error by which methods are compared
TINY = 1e-9  # error less than which none counts
PROVING = 150.0  # s of processor time for a reference, all cores together; straight rays seldom take as much
TIMING = 8.0  # s
CLOCKED = 0.01  # s, that a timed call is to take at least, by tracing more pings if need be
MOST_CLOCKED = 512  # pings
RAYS_OF_TRIANGLES = 1 << 20

Record = NDArray[np.float32]


@dataclass(frozen=True)
class Row:
    """One method with one setting.

    Attributes
    ----------
    method : str
        Its name.
    setting : str
        As a person reads it.
    size : float
        The setting as a number: metres a step, rays a side, planes.
    targets : bool
        Whether the scene's targets are there.
    microseconds : float
        Median per ping, both sides, on one thread.
    spread : float
        Half the distance between the quartiles of the times, as a share of the median.
    errors : Errors
        Shares of the record.
    displacement : Displacement
        Of shadows and echoes, in metres.
    """

    method: str
    setting: str
    size: float
    targets: bool
    microseconds: float
    spread: float
    errors: Errors
    displacement: Displacement

    @property
    def name(self) -> Name:
        """What tells it from the others."""
        return Name(self.method, self.setting, self.targets)

    @property
    def label(self) -> str:
        """The setting without the words that its method implies."""
        return self.setting.removesuffix("s").removesuffix(" plane").removesuffix(" ray")


class Case(NamedTuple):
    """A scene with its targets or without.

    Attributes
    ----------
    problem : Problem
        As kernels see it.
    poses : Poses
        Of the n pings that are compared.
    reference : Reference
        What is right.
    of_triangles : Reference, optional
        What is right of a bed of triangles.
    """

    arrays: SceneArrays
    poses: Poses
    reference: Reference
    of_triangles: Reference | None = None

    def judge(self, method: str) -> Reference:
        """Return what a method is judged by."""
        return self.of_triangles if method == EMBREE_OWN and self.of_triangles is not None else self.reference


@dataclass(frozen=True)
class Chart:
    """What was measured.

    Attributes
    ----------
    title : str
        Of the scene.
    rows : tuple of Row
        All methods and settings.
    pings : int
        Pings that were compared.
    machine : str
        Where and with what it was measured.
    cases : mapping of bool to Case
        By whether the targets are there; what has none has only ``False``.
    records : mapping of Name to (pings, 2, bins) float32
        What every row was judged by.
    notes : tuple of str
        What was left out, and why.
    """

    title: str
    rows: tuple[Row, ...]
    pings: int
    machine: str
    cases: Mapping[bool, Case] = field(repr=False)
    records: Mapping[Name, Record] = field(repr=False)
    notes: tuple[str, ...] = ()

    def front(self, targets: bool) -> list[Row]:
        """Return the rows that none beats in both time and error, fastest first, with targets or without."""
        front: list[Row] = []
        rows = (row for row in self.rows if row.targets == targets and row.method != EMBREE_OWN)
        for row in sorted(rows, key=lambda row: (row.microseconds, row.errors.beyond)):
            if not front or row.errors.beyond < front[-1].errors.beyond:
                front.append(row)
        return front

    def time_to(self, method: str, error: float, targets: bool) -> float:
        """Return after how many microseconds a ping a method comes within an error, with targets or without.

        Between the two of its settings that lie about it the error is taken to fall as a power of the time; NaN where
        no setting comes so near, or the reference does not tell.
        """
        if error < self.cases[targets].reference.floor:
            return math.nan
        before: Row | None = None
        for row in sorted((one for one in self.rows if (one.method, one.targets) == (method, targets)), key=_time_of):
            if row.errors.beyond <= error:
                if before is None:
                    return row.microseconds
                fall = math.log(before.errors.beyond / max(row.errors.beyond, TINY))
                share = math.log(before.errors.beyond / error) / fall
                return before.microseconds * (row.microseconds / before.microseconds) ** share
            before = row
        return math.nan

    def lead(self, targets: bool) -> str:
        """Tell how much sooner the sweep comes near the truth than exact rays do; nothing where either does not."""
        from insonify.accuracy.charts.style import as_percent, as_time

        sweeps, exact = (self.time_to(method, AS_NEAR, targets) for method in ("sweep", "rays"))
        if not exact / sweeps > 0.0:
            return ""
        times = f"{exact / sweeps:,.0f}" if exact > 10.0 * sweeps else f"{exact / sweeps:.2g}"
        return f"{as_percent(AS_NEAR)} in {as_time(sweeps)} by the sweep, in {as_time(exact)} by exact rays: × {times}"

    @property
    def told(self) -> tuple[str, ...]:
        """What there is to tell in words: how much sooner the sweep is, and what was left out."""
        which = {False: "without targets: ", True: "with targets: "} if len(self.cases) > 1 else {}
        leads = {targets: self.lead(targets) for targets in sorted(self.cases)}
        return (*(which.get(targets, "") + lead for targets, lead in leads.items() if lead), *self.notes)

    def shown(self, row: Row) -> tuple[Record, Record]:
        """Return a row's record and its reference as a picture shows them: amplitudes over those of a level bed.

        Returns
        -------
        record, reference : (pings, 2, bins) float32
        """
        case = self.cases[row.targets]
        curve = np.array([held_curve(curve[0]) for curve in flat_bed_curves(case.arrays, case.poses)])[:, None, :]
        return normalise(self.records[row.name], curve), normalise(case.judge(row.method).record, curve)

    def save(self, path: str | Path) -> None:
        """Write the chart as a picture (.png, .svg) or as a table (.csv, .json).

        Raises
        ------
        SceneError
            If the file's name ends in anything else.
        """
        from insonify.accuracy.charts.figure import draw
        from insonify.accuracy.charts.files import save
        from insonify.accuracy.charts.tables import accuracy_table

        save(path, accuracy_table(self), lambda: draw(self).figure)


def chart(scene: Scene, *, pings: int = PINGS, progress: Callable[[float], None] | None = None) -> Chart:
    """Measure time per ping and error of every method on a scene, on this machine.

    Parameters
    ----------
    scene : Scene
        What to trace.
    pings : int
        Pings to compare, spread evenly over the track.
    progress : callable, optional
        Called now and then with the share done, from 0 to 1; may raise to stop.

    Returns
    -------
    Chart

    Raises
    ------
    SceneError
        If there are no pings to trace, or the scene cannot be simulated.
    """
    if pings < 1:
        raise SceneError(f"pings: {pings} is too few; give at least 1")
    scenes = {False: edit(scene, {"targets": []})} if scene.targets else {}
    scenes |= {bool(scene.targets): scene}
    rows: list[Row] = []
    cases: dict[bool, Case] = {}
    records: dict[Name, Record] = {}
    for number, (targets, one) in enumerate(scenes.items()):

        def share(done: float, before: int = number) -> None:
            if progress is not None:
                progress((before + done) / len(scenes))

        arrays, poses = ready(one, pings)
        measured, case, found = _measure(targets, arrays, poses, share)
        rows += measured
        cases[targets] = case
        records |= found
    notes = dict.fromkeys(filter(None, map(_note, cases.values())))
    return Chart(scene.title, tuple(rows), cases[False].poses.x.size, machine(), cases, records, tuple(notes))


def _time_of(row: Row) -> float:
    return row.microseconds


def _note(case: Case) -> str:
    """Tell how far the triangles themselves are from the bilinear bed, or why there are none."""
    if case.of_triangles is None:
        return why_not(case.arrays, case.poses)
    apart = compare(case.arrays, case.poses, case.of_triangles.record, case.reference.record).beyond
    return (
        f"embree: its triangles themselves, with {case.of_triangles.rays:,} rays a side, are {100.0 * apart:.2g} % "
        "from the bilinear bed; the rest of its error is that of its rays"
    )


def ready(scene: Scene, pings: int) -> tuple[SceneArrays, Poses]:
    """Make a scene ready to be traced in full: whatever bends bends, however little.

    Parameters
    ----------
    scene : Scene
        What to trace.
    pings : int
        Pings, spread evenly over the track; of endless ground, those over the piece beneath most of them.

    Returns
    -------
    Problem, Poses
    """
    straight = not prepare(scene).plan.bent  # and refuses what cannot be simulated
    ground = build_ground(scene)
    arrays = pack_scene(scene, ground)
    if straight and (arrays.multipath.enabled or arrays.bounces):
        arrays = arrays._replace(water=still_water(arrays.water.reference, arrays.water.surface))
    poses = make_poses(scene, ground, np.unique(np.linspace(0, scene.track.pings - 1, pings).astype(np.int64)))
    pieces = TerrainTiles(ground, arrays.bins * arrays.bin_length).split(arrays, poses)
    places, arrays = max(pieces, key=lambda piece: poses.x[piece[0]].size)
    return arrays, take_poses(poses, places)


def _measure(
    targets: bool, arrays: SceneArrays, poses: Poses, progress: Callable[[float], None]
) -> tuple[list[Row], Case, dict[Name, Record]]:
    """Trace, prove the reference, time and compare."""
    named = {Name(one.method, one.setting, targets): one for one in contenders(arrays, poses)}
    records: dict[Name, Record] = {}
    for number, (name, one) in enumerate(named.items()):
        progress(0.2 * number / len(named))
        records[name] = one.trace(poses)
    right = prove(arrays, poses, list(records.values()), seconds=PROVING, progress=lambda s: progress(0.2 + 0.5 * s))
    case = Case(arrays, poses, right, _right_of_triangles(arrays, poses, lambda: progress(0.7)))
    clocked = {}
    for name, one in named.items():
        progress(0.7)
        clocked[name] = _clocked(one, poses)
    timings = time_calls(
        {name: call for name, (call, _) in clocked.items()},
        seconds=TIMING,
        clock=thread_time,
        progress=lambda share: progress(0.7 + 0.3 * share),
    )
    rows = []
    for name, one in named.items():
        timing = timings[name]
        per_ping = 1e6 * timing.median / clocked[name][1]
        for method in (one.method, EMBREE_OWN) if one.method == EMBREE else (one.method,):
            records[name._replace(method=method)] = records[name]
            pair = records[name], case.judge(method).record
            errors, moved = compare(arrays, poses, *pair), displacement(arrays, poses, *pair)
            rows.append(Row(method, one.setting, one.size, targets, per_ping, timing.spread, errors, moved))
    return sorted(rows, key=lambda row: row.method == EMBREE_OWN), case, records


def _right_of_triangles(arrays: SceneArrays, poses: Poses, told: Callable[[], None]) -> Reference | None:
    """Trace a bed of triangles with many rays, and with half as many; None where it is not traced at all."""
    if why_not(arrays, poses):
        return None
    bed = TriangulatedBed(arrays, poses)
    half, whole = (_ping_by_ping(bed, poses, count, told) for count in (RAYS_OF_TRIANGLES // 2, RAYS_OF_TRIANGLES))
    moved = compare(arrays, poses, half, whole)
    return Reference(whole, moved.beyond, RAYS_OF_TRIANGLES, moved.all_bins)


def _ping_by_ping(bed: TriangulatedBed, poses: Poses, rays: int, told: Callable[[], None]) -> Record:
    """Trace with many rays; ``told`` is called after every ping."""
    records = []
    for ping in range(poses.x.size):
        records.append(bed.trace(take_poses(poses, slice(ping, ping + 1)), rays=rays))
        told()
    return np.concatenate(records)


def _clocked(one: Contender, poses: Poses) -> tuple[Callable[[], Record], int]:
    """Let a quick method trace pings again and again, so that a call takes long enough to be timed; say how many."""
    began = thread_time()
    one.trace(poses)
    times = math.ceil(CLOCKED / max(thread_time() - began, 1e-6))
    many = take_poses(poses, np.tile(np.arange(poses.x.size), max(min(times, MOST_CLOCKED // poses.x.size), 1)))
    return partial(one.trace, many), many.x.size
