"""Time and memory of a record against the size of the scene and of the model, measured on this machine."""

import tracemalloc
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from time import thread_time
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from insonify.accuracy.charts import style
from insonify.accuracy.charts.chart import Chart, ChartTable
from insonify.accuracy.charts.method_settings import coarsen_bed, pack_for_chart
from insonify.accuracy.timing import describe_machine, time_calls
from insonify.display.style import FAINT, label_axes
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.kernels.geometry.bvh import build_mesh
from insonify.planning import plan
from insonify.scene import Scene, edit
from insonify.simulation import Simulation, prepare
from insonify.tracers import rays, sweep

PINGS = (16, 32, 64, 128, 256, 512)
STREAMED = (1000, 10_000, 100_000, 1_000_000)  # pings of a record that is traced block by block
LONGEST = 10.0  # s, greatest cost of such a record by its plan
NODES = (8, 4, 2, 1)  # strides between the nodes of the bed that are kept
BED_NODES = (1024, 2048, 4096, 8192)  # nodes of the bed
BINS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)  # times the bins of the scene
TARGETS = (1, 2, 5, 10, 20, 50, 100, 200)
DIVISIONS = (2, 4, 6, 8)  # of an icosahedron, each into four times as many triangles: 320 to 1.3 million
PLANES = (1, 2, 4, 8, 16, 32, 64, 128)
RAYS = (500, 1000, 2000, 4000, 8000)
SWEPT, CAST = 32, 4  # pings of a call of the sweep, and of rays
CAST_RAYS = 2000  # rays per side where another size grows
SECONDS = 15.0
RADIUS = 0.5  # m, of the ball of triangles
SMALL = 0.15  # m, radius of the targets; the greatest number of them in one beam do not touch
WHOLE = ("pings", "pings of a streamed record")  # axes with the time of all pings
TABLE_COLUMNS = ("method", "axis", "size", "microseconds", "spread", "megabytes", "exponent", "exponent_spread")


class CostRow(NamedTuple):
    """Time of one method at one size."""

    method: str  # sweep or rays
    axis: str  # quantity that grows
    size: float  # value of that quantity
    microseconds: float  # median time: of all pings where their number grows, else of one
    spread: float  # half the distance between the quartiles, as a share of the median
    megabytes: float  # memory of the scene's arrays plus the peak allocation of a call


@dataclass(frozen=True)
class CostChart(Chart):
    """Time against size."""

    title: str  # title of the scene
    rows: tuple[CostRow, ...]  # axis by axis, method by method, from small to large
    machine: str  # processor and versions of the measurement

    def group(self) -> dict[tuple[str, str], list[CostRow]]:
        """Rows by axis and method."""
        return style.group_by(self.rows, lambda row: (row.axis, row.method))

    def fits(self) -> dict[tuple[str, str], style.PowerLawFit]:
        """Power law of the time for every axis and method."""
        return {
            key: style.fit_power_law([row.size for row in rows], [row.microseconds for row in rows])
            for key, rows in self.group().items()
        }

    def tabulate(self) -> ChartTable:
        """Lay the rows out, each with the power law of its axis and method."""
        fits = self.fits()
        rows = [(*row, *fits[row.axis, row.method][:2]) for row in self.rows]
        return ChartTable({"title": self.title, "machine": self.machine}, TABLE_COLUMNS, rows)

    def draw(self) -> Figure:
        """Draw time against size, a panel for each axis, with the fitted power laws."""
        fits, groups = self.fits(), self.group()
        names = list(dict.fromkeys(axis for axis, _ in groups))
        figure, panels = style.lay_out_panels(len(names), 3)
        style.write_headings(figure, "Cost against size", self.title or "untitled scene", self.machine)
        for axes, axis in zip(panels, names):
            style.scale_axes(axes, x=style.format_count, y=style.format_time)
            label_axes(axes, axis)
            what = "time of all pings" if axis in WHOLE else "time per ping"
            axes.set_title(what, fontsize=9.5, color=FAINT, loc="left")
            for (of, method), rows in groups.items():
                if of == axis:
                    x, y = [row.size for row in rows], [row.microseconds for row in rows]
                    bars = [row.spread * row.microseconds for row in rows]
                    style.draw_series(axes, method, x, y, fits[axis, method], "size", bars)
            style.finish_panel(axes)
        return figure


Sizes = Iterator[tuple[float, SceneArrays, Poses]]  # sizes of a scene, each with its arrays and poses


def measure_chart(scene: Scene, *, progress: Callable[[float], None] | None = None) -> CostChart:
    """Measure time and memory against the number of pings, nodes, cells, bins, targets, triangles, planes and rays."""
    planes = plan(scene).planes
    arrays, poses = pack_for_chart(scene, SWEPT)
    calls: dict[tuple[str, str, float], partial[Any]] = {}  # of each, the first arguments are arrays and poses
    calls |= {("sweep", "pings", n): _sweep(arrays, _some(poses, n), planes) for n in PINGS}
    calls |= {("rays", "pings", n): _rays(arrays, _some(poses, n)) for n in PINGS[:3]}
    if arrays.bed.periodic:
        calls |= {("sweep", WHOLE[1], n): call for n, call in _stream_records(scene)}
    axes = {
        "cells along a profile": _coarsen_beds(arrays, poses),
        "bins a side": _change_bins(scene),
        "nodes of the bed": _tile_beds(arrays, poses),
        "targets in the beam": _add_targets(scene),
        "triangles in the beam": _refine_ball(scene),
    }
    for axis, sizes in axes.items():
        for size, changed, towed in sizes:
            calls["sweep", axis, size] = _sweep(changed, towed, planes)
            calls["rays", axis, size] = _rays(changed, _some(towed, CAST))
    if arrays.half_width > 0.0:
        calls |= {("sweep", "planes", count): _sweep(arrays, poses, count) for count in PLANES}
    calls |= {("rays", "rays a side", count): _rays(arrays, _some(poses, CAST), count) for count in RAYS}
    memory = {key: _memory_of(call) for key, call in calls.items()}
    timings = time_calls(calls, seconds=SECONDS, clock=thread_time, progress=progress or (lambda _: None))
    rows = []
    for key, timing in timings.items():
        pings = 1 if key[1] in WHOLE else calls[key].args[1].x.size
        rows.append(CostRow(*key, 1e6 * timing.median / pings, timing.spread, memory[key]))
    return CostChart(scene.title, tuple(rows), describe_machine())


def _sweep(arrays: SceneArrays, poses: Poses, planes: int) -> partial[Any]:
    return partial(sweep.trace, arrays, poses, planes=planes, threads=1)


def _rays(arrays: SceneArrays, poses: Poses, count: int = CAST_RAYS) -> partial[Any]:
    return partial(rays.trace, arrays, poses, rays=count, threads=1)


def _memory_of(call: partial[Any]) -> float:
    """Megabytes of the arrays of a call's scene plus the peak allocation of the call."""
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
    all_poses = poses.x.size
    places = np.resize(np.arange(all_poses), count) if count > all_poses else np.linspace(0, all_poses - 1, count)
    return Poses(*(np.ascontiguousarray(column[places.astype(np.int64)]) for column in poses))


def _stream_records(scene: Scene) -> Iterator[tuple[int, partial[Any]]]:
    """Whole records traced block by block, as for a file, as long as the plan predicts a few seconds."""
    for n in STREAMED:
        simulation = prepare(edit(scene, {"track.pings": n}), threads=1)
        if n * simulation.plan.cost <= LONGEST:
            yield n, partial(_stream, simulation.reduced, simulation)


def _stream(_: SceneArrays, simulation: Simulation) -> None:
    for _block in simulation.record_blocks():
        pass


def _coarsen_beds(arrays: SceneArrays, poses: Poses) -> Sizes:
    """Keep fewer nodes of the bed, by cells along a profile."""
    for every in NODES:
        if (bed := coarsen_bed(arrays.bed, every)) is not None:
            yield round(arrays.bins * arrays.bin_length / bed.spacing), arrays._replace(bed=bed), poses


def _change_bins(scene: Scene) -> Sizes:
    """Record the scene with fewer and with more bins."""
    for times in BINS:
        arrays, poses = pack_for_chart(edit(scene, {"sonar.bins": max(round(times * scene.sonar.bins), 1)}), SWEPT)
        yield arrays.bins, arrays, poses


def _tile_beds(arrays: SceneArrays, poses: Poses) -> Sizes:
    """Lay a periodic bed side by side, with pings all over it, by nodes of the bed."""
    bed = arrays.bed
    for side in BED_NODES if bed.periodic else ():
        times = side // max(bed.heights.shape)
        if times > 0:
            wide = bed._replace(
                heights=np.tile(bed.heights, (times, times)),
                transposed=np.tile(bed.transposed, (times, times)),
                materials=np.tile(bed.materials, (times, times)),
            )
            away = np.arange(poses.x.size) % times * bed.spacing
            x, y = poses.x + away * bed.heights.shape[1], poses.y + away[::-1] * bed.heights.shape[0]
            yield wide.heights.size, arrays._replace(bed=wide), poses._replace(x=x, y=y)


def _slow_down(scene: Scene, radius: float) -> dict[str, Any]:
    """Slow the track down, so that all timed pings meet targets of a radius at its start."""
    return {"track.speed": min(scene.track.speed, scene.sonar.ping_rate * radius / SWEPT), "track.pings": SWEPT}


def _add_targets(scene: Scene) -> Sizes:
    """Place spheres on both sides of the timed pings."""
    for count in TARGETS:
        targets = {"targets": _spheres(scene, count, SMALL)}
        yield count, *pack_for_chart(edit(scene, _slow_down(scene, SMALL) | targets), SWEPT)


def _refine_ball(scene: Scene) -> Sizes:
    """Place a ball of more and more triangles beneath the timed pings on the port side."""
    import trimesh.creation  # slow to import, and no other axis needs it

    (ball,) = _spheres(scene, 1, RADIUS)
    arrays, poses = pack_for_chart(edit(scene, _slow_down(scene, RADIUS) | {"targets": []}), SWEPT)
    for divisions in DIVISIONS:
        corners = trimesh.creation.icosphere(subdivisions=divisions, radius=RADIUS).triangles + ball["position"]
        first = np.zeros(len(corners), np.int64)
        yield len(corners), arrays._replace(mesh=build_mesh(np.asarray(corners, float), first, first)), poses


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
