"""Time and memory of a record against the size of the scene and of the model, measured on this machine."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from time import thread_time
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.charts.chart import Chart, ChartTable
from insonify.accuracy.charts.machine import describe_machine
from insonify.accuracy.charts.method_settings import coarsen_bed
from insonify.accuracy.charts.power_law import PowerLawFit, fit_power_law
from insonify.accuracy.charts.scene_setup import pack_for_chart
from insonify.accuracy.charts.series_figure import draw_series, finish_panel, format_count, lay_out_panels
from insonify.accuracy.charts.style import format_time, scale_axes, write_headings
from insonify.accuracy.timing import time_calls
from insonify.display.style import FAINT, label_axes
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.geometry.bvh import build_mesh
from insonify.planning import plan
from insonify.record.blocks import trace_blocks
from insonify.scene import Scene, edit
from insonify.simulation import Simulation, prepare
from insonify.tracers import rays, sweep

PINGS = (16, 32, 64, 128, 256, 512)
STREAMED = (1000, 10_000, 100_000, 1_000_000)  # pings of a record that is traced block by block
LONGEST = 10.0  # s, that such a record may take by its plan
NODES = (8, 4, 2, 1)  # one node of so many of the bed is kept
SIDES = (1024, 2048, 4096, 8192)  # nodes of the bed
BINS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  # times the bins of the scene
TARGETS = (1, 2, 5, 10, 20, 50, 100, 200)
DIVISIONS = (2, 4, 6, 8)  # of an icosahedron, each into four times as many triangles: 320 to 1.3 million
PLANES = (1, 2, 4, 8, 16, 32, 64, 128)
RAYS = (500, 1000, 2000, 4000, 8000)
SWEPT, CAST = 32, 4  # pings of a call of the sweep, and of rays
CAST_RAYS = 2000  # rays per side where another size grows
SECONDS = 15.0
RADIUS = 0.5  # m, of the ball of triangles
SMALL = 0.15  # m, radius of the targets, of which the most in one beam stand clear of one another
WHOLE = ("pings", "pings of a streamed record")  # axes of which the time is that of all pings
COLUMNS = ("method", "axis", "size", "microseconds", "spread", "megabytes", "exponent", "exponent_spread")


class CostRow(NamedTuple):
    """Time of one method at one size."""

    method: str  # sweep or rays
    axis: str  # quantity that grows
    size: float  # value of that quantity
    microseconds: float  # median time: of all pings where their number grows, else of one
    spread: float  # half the distance between the quartiles, as a share of the median
    megabytes: float  # memory of the scene's arrays, and the most that a call holds besides


@dataclass(frozen=True)
class CostChart(Chart):
    """Time against size."""

    title: str  # title of the scene
    rows: tuple[CostRow, ...]  # axis by axis, method by method, from small to large
    machine: str  # processor and versions of the measurement

    def group(self) -> dict[tuple[str, str], list[CostRow]]:
        """Rows by axis and method."""
        groups: dict[tuple[str, str], list[CostRow]] = {}
        for row in self.rows:
            groups.setdefault((row.axis, row.method), []).append(row)
        return groups

    def fits(self) -> dict[tuple[str, str], PowerLawFit]:
        """Power law of the time for every axis and method."""
        return {
            key: fit_power_law([row.size for row in rows], [row.microseconds for row in rows])
            for key, rows in self.group().items()
        }

    def tabulate(self) -> ChartTable:
        """Lay the rows out, each with the power law of its axis and method."""
        fits = self.fits()
        rows = [(*row, *fits[row.axis, row.method][:2]) for row in self.rows]
        return ChartTable({"title": self.title, "machine": self.machine}, COLUMNS, rows)

    def draw(self) -> Figure:
        """Draw time against size, a panel for each axis, with the fitted power laws."""
        fits, groups = self.fits(), self.group()
        names = list(dict.fromkeys(axis for axis, _ in groups))
        figure, panels = lay_out_panels(len(names), 3)
        write_headings(figure, "Cost against size", self.title or "untitled scene", self.machine)
        for axes, axis in zip(panels, names):
            scale_axes(axes, x=format_count, y=format_time)
            label_axes(axes, axis)
            what = "time of all pings" if axis in WHOLE else "time per ping"
            axes.set_title(what, fontsize=9.5, color=FAINT, loc="left")
            for (of, method), rows in groups.items():
                if of == axis:
                    x, y = [row.size for row in rows], [row.microseconds for row in rows]
                    bars = [row.spread * row.microseconds for row in rows]
                    draw_series(axes, method, x, y, fits[axis, method], "size", bars)
            finish_panel(axes)
        return figure


Calls = dict[tuple[str, str, float], tuple[partial[Any], int]]


def measure_chart(scene: Scene, *, progress: Callable[[float], None] | None = None) -> CostChart:
    """Measure time and memory against the number of pings, nodes, cells, bins, targets, triangles, planes and rays."""
    planes = plan(scene).planes
    arrays, poses = pack_for_chart(scene, SWEPT)
    calls = (
        _of_pings(arrays, poses, planes)
        | _of_streams(scene, arrays.bed.periodic)
        | _of_cells(arrays, poses, planes)
        | _of_bins(scene, planes)
    )
    calls |= _of_nodes(arrays, poses, planes) | _of_targets(scene, planes) | _of_triangles(scene, planes)
    for count in PLANES if arrays.half_width > 0.0 else ():
        calls["sweep", "planes", count] = _sweep(arrays, poses, count)
    for count in RAYS:
        calls["rays", "rays a side", count] = _rays(arrays, poses, count)
    memory = {key: _memory_of(call) for key, (call, _) in calls.items()}
    timings = time_calls(
        {key: call for key, (call, _) in calls.items()},
        seconds=SECONDS,
        clock=thread_time,
        progress=progress or (lambda _: None),
    )
    rows = [
        CostRow(*key, 1e6 * timing.median / (1 if key[1] in WHOLE else calls[key][1]), timing.spread, memory[key])
        for key, timing in timings.items()
    ]
    return CostChart(scene.title, tuple(rows), describe_machine())


def _sweep(arrays: SceneArrays, poses: Poses, planes: int) -> tuple[partial[Any], int]:
    return partial(sweep.trace, arrays, poses, planes=planes, threads=1), poses.x.size


def _rays(arrays: SceneArrays, poses: Poses, count: int = CAST_RAYS) -> tuple[partial[Any], int]:
    some = _some(poses, CAST)
    return partial(rays.trace, arrays, some, rays=count, threads=1), some.x.size


def _memory_of(call: partial[Any]) -> float:
    """Megabytes of the arrays of a call's scene, and the most that the call holds besides."""
    tracemalloc.start()
    try:
        call()
        return (_bytes_of(call.args[0]) + tracemalloc.get_traced_memory()[1]) / 1e6
    finally:
        tracemalloc.stop()


def _bytes_of(value: Any) -> int:
    """Bytes of all arrays of a tuple of tuples."""
    if isinstance(value, tuple):
        return sum(_bytes_of(part) for part in value)
    return value.nbytes if isinstance(value, np.ndarray) else 0


def _some(poses: Poses, count: int) -> Poses:
    """Pick a number of poses evenly, or repeat them if there are fewer."""
    places = (
        np.resize(np.arange(poses.x.size), count) if count > poses.x.size else np.linspace(0, poses.x.size - 1, count)
    )
    return Poses(*(np.ascontiguousarray(column[places.astype(np.int64)]) for column in poses))


def _both(axis: str, size: float, arrays: SceneArrays, poses: Poses, planes: int) -> Calls:
    return {("sweep", axis, size): _sweep(arrays, poses, planes), ("rays", axis, size): _rays(arrays, poses)}


def _of_pings(arrays: SceneArrays, poses: Poses, planes: int) -> Calls:
    calls: Calls = {("sweep", "pings", n): _sweep(arrays, _some(poses, n), planes) for n in PINGS}
    for n in PINGS[:3]:
        some = _some(poses, n)
        calls["rays", "pings", n] = partial(rays.trace, arrays, some, rays=CAST_RAYS, threads=1), n
    return calls


def _of_streams(scene: Scene, periodic: bool) -> Calls:
    """Trace whole records block by block, as they are written, as far as that is a matter of seconds."""
    calls: Calls = {}
    for n in STREAMED if periodic else ():
        simulation = prepare(edit(scene, {"track.pings": n}), threads=1)
        if n * simulation.plan.cost <= LONGEST:
            calls["sweep", WHOLE[1], n] = partial(_stream, simulation.reduced, simulation), n
    return calls


def _stream(_: SceneArrays, simulation: Simulation) -> None:
    for _block in trace_blocks(simulation):
        pass


def _of_cells(arrays: SceneArrays, poses: Poses, planes: int) -> Calls:
    """Trace the same bed with fewer nodes, by cells along a profile."""
    calls: Calls = {}
    for every in NODES:
        if (bed := coarsen_bed(arrays.bed, every)) is not None:
            cells = round(arrays.bins * arrays.bin_length / bed.spacing)
            calls |= _both("cells along a profile", cells, arrays._replace(bed=bed), poses, planes)
    return calls


def _of_nodes(arrays: SceneArrays, poses: Poses, planes: int) -> Calls:
    """Trace a periodic bed laid side by side, with pings all over it, by nodes of the bed."""
    calls: Calls = {}
    bed = arrays.bed
    for side in SIDES if bed.periodic else ():
        times = side // max(bed.heights.shape)
        if times > 0:
            wide = bed._replace(
                heights=np.tile(bed.heights, (times, times)),
                transposed=np.tile(bed.transposed, (times, times)),
                materials=np.tile(bed.materials, (times, times)),
            )
            away = np.arange(poses.x.size) % times * bed.spacing
            moved = poses._replace(
                x=poses.x + away * bed.heights.shape[1], y=poses.y + away[::-1] * bed.heights.shape[0]
            )
            calls |= _both("nodes of the bed", wide.heights.size, arrays._replace(bed=wide), moved, planes)
    return calls


def _of_bins(scene: Scene, planes: int) -> Calls:
    calls: Calls = {}
    for times in BINS:
        arrays, poses = pack_for_chart(edit(scene, {"sonar.bins": max(round(times * scene.sonar.bins), 1)}), SWEPT)
        calls |= _both("bins a side", arrays.bins, arrays, poses, planes)
    return calls


def _of_targets(scene: Scene, planes: int) -> Calls:
    """Trace scenes with spheres on both sides of the timed pings, all of which meet them."""
    calls: Calls = {}
    near = {"track.speed": min(scene.track.speed, scene.sonar.ping_rate * SMALL / SWEPT), "track.pings": SWEPT}
    for count in TARGETS:
        arrays, poses = pack_for_chart(edit(scene, {**near, "targets": _spheres(scene, count, SMALL)}), SWEPT)
        calls |= _both("targets in the beam", count, arrays, poses, planes)
    return calls


def _of_triangles(scene: Scene, planes: int) -> Calls:
    """Trace a ball of more and more triangles, beneath the timed pings on the port side."""
    import trimesh.creation  # slow to import, and no other axis needs it

    calls: Calls = {}
    near = {"track.speed": min(scene.track.speed, scene.sonar.ping_rate * RADIUS / SWEPT), "track.pings": SWEPT}
    (ball,) = _spheres(scene, 1, RADIUS)
    arrays, poses = pack_for_chart(edit(scene, {**near, "targets": []}), SWEPT)
    for divisions in DIVISIONS:
        corners = trimesh.creation.icosphere(subdivisions=divisions, radius=RADIUS).triangles + ball["position"]
        first = np.zeros(len(corners), np.int64)
        meshed = arrays._replace(mesh=build_mesh(np.asarray(corners, float), first, first))
        calls |= _both("triangles in the beam", len(corners), meshed, poses, planes)
    return calls


def _spheres(scene: Scene, count: int, radius: float) -> list[Mapping[str, Any]]:
    """Spheres athwart the track's start, port and starboard in turn, from 1.2 altitudes to most of the range."""
    heading = np.radians(scene.track.heading)
    out: list[Mapping[str, Any]] = []
    for k, away in enumerate(np.linspace(1.2 * abs(scene.altitude), 0.9 * scene.sonar.range, count)):
        across = float(away) * (1.0 if k % 2 == 0 else -1.0)
        x, y = scene.track.start[0] - across * np.sin(heading), scene.track.start[1] + across * np.cos(heading)
        height = -scene.seabed.depth + radius
        out.append({"kind": "sphere", "radius": radius, "position": [float(x), float(y), height]})
    return out
