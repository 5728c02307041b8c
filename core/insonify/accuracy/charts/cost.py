"""What a record costs, against the size of what is asked, measured on this machine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from time import thread_time
from typing import Any, NamedTuple

import numpy as np

from insonify.accuracy.charts.contenders import coarser
from insonify.accuracy.charts.fit import Fit, fit_power
from insonify.accuracy.charts.machine import machine
from insonify.accuracy.charts.measure import ready
from insonify.accuracy.metrics import time_calls
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.planning import plan
from insonify.scene import Scene, edit
from insonify.tracers import rays, sweep

PINGS = (16, 32, 64, 128, 256, 512)
NODES = (8, 4, 2, 1)  # of the bed, of which one is kept
BINS = (0.25, 0.5, 1.0, 2.0, 4.0)  # times those of the scene
TARGETS = (1, 2, 4, 8, 16, 32)
PLANES = (1, 2, 4, 8, 16, 32, 64)
RAYS = (500, 1000, 2000, 4000, 8000)
SWEPT, CAST = 32, 4  # pings a call of the sweep, and of rays
CAST_RAYS = 2000  # where their number is not what grows
SECONDS = 15.0
RADIUS = 0.5  # m, of the targets


class Cost(NamedTuple):
    """One measurement.

    Attributes
    ----------
    method : str
        Sweep or rays.
    axis : str
        What grows.
    size : float
        How large it is.
    microseconds : float
        Median of the time: of all pings where their number grows, else of one.
    spread : float
        Half the distance between the quartiles, as a share of the median.
    """

    method: str
    axis: str
    size: float
    microseconds: float
    spread: float


@dataclass(frozen=True)
class CostChart:
    """Time against size.

    Attributes
    ----------
    title : str
        Of the scene.
    rows : tuple of Cost
        Axis by axis, method by method, from small to large.
    machine : str
        Where and with what it was measured.
    """

    title: str
    rows: tuple[Cost, ...]
    machine: str

    def fits(self) -> dict[tuple[str, str], Fit]:
        """Fit a power law to every axis and method."""
        keys = dict.fromkeys((row.axis, row.method) for row in self.rows)
        return {key: self._fit(*key) for key in keys}

    def _fit(self, axis: str, method: str) -> Fit:
        rows = [row for row in self.rows if (row.axis, row.method) == (axis, method)]
        return fit_power([row.size for row in rows], [row.microseconds for row in rows])

    def save(self, path: str | Path) -> None:
        """Write the chart as a picture (.png, .svg) or as a table (.csv, .json).

        Raises
        ------
        SceneError
            If the file's name ends in anything else.
        """
        from insonify.accuracy.charts.files import save
        from insonify.accuracy.charts.law_figures import draw_cost
        from insonify.accuracy.charts.tables import cost_table

        save(path, cost_table(self), lambda: draw_cost(self))


Calls = dict[tuple[str, str, float], tuple[Callable[[], Any], int]]


def cost_chart(scene: Scene, *, progress: Callable[[float], None] | None = None) -> CostChart:
    """Measure time against the number of pings, of cells along a profile, bins, targets, planes and rays.

    Parameters
    ----------
    scene : Scene
        What everything else is as in.
    progress : callable, optional
        Called now and then with the share done, from 0 to 1; may raise to stop.

    Returns
    -------
    CostChart

    Raises
    ------
    SceneError
        If the scene cannot be simulated.
    """
    planes = plan(scene).planes
    arrays, poses = ready(scene, SWEPT)
    calls = _of_pings(arrays, poses, planes) | _of_cells(arrays, poses, planes) | _of_bins(scene, planes)
    calls |= _of_targets(scene, planes)
    for count in PLANES if arrays.half_width > 0.0 else ():
        calls["sweep", "planes", count] = _sweep(arrays, poses, count)
    for count in RAYS:
        calls["rays", "rays a side", count] = _rays(arrays, poses, count)
    timings = time_calls(
        {key: call for key, (call, _) in calls.items()},
        seconds=SECONDS,
        clock=thread_time,
        progress=progress or (lambda _: None),
    )
    rows = [
        Cost(*key, 1e6 * timing.median / (1 if key[1] == "pings" else calls[key][1]), timing.spread)
        for key, timing in timings.items()
    ]
    return CostChart(scene.title, tuple(rows), machine())


def _sweep(arrays: SceneArrays, poses: Poses, planes: int) -> tuple[Callable[[], Any], int]:
    return partial(sweep.trace, arrays, poses, planes=planes, threads=1), poses.x.size


def _rays(arrays: SceneArrays, poses: Poses, count: int = CAST_RAYS) -> tuple[Callable[[], Any], int]:
    some = _some(poses, CAST)
    return partial(rays.trace, arrays, some, rays=count, threads=1), some.x.size


def _some(poses: Poses, count: int) -> Poses:
    """So many of the poses, or the same again and again."""
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


def _of_cells(arrays: SceneArrays, poses: Poses, planes: int) -> Calls:
    """Cells along a profile: the same bed of fewer nodes."""
    calls: Calls = {}
    for every in NODES:
        if (bed := coarser(arrays.bed, every)) is not None:
            cells = round(arrays.bins * arrays.bin_length / bed.spacing)
            calls |= _both("cells along a profile", cells, arrays._replace(bed=bed), poses, planes)
    return calls


def _of_bins(scene: Scene, planes: int) -> Calls:
    calls: Calls = {}
    for times in BINS:
        arrays, poses = ready(edit(scene, {"sonar.bins": max(round(times * scene.sonar.bins), 1)}), SWEPT)
        calls |= _both("bins a side", arrays.bins, arrays, poses, planes)
    return calls


def _of_targets(scene: Scene, planes: int) -> Calls:
    """Spheres on the bed, on both sides of the pings that are timed, which all lie within a few metres."""
    calls: Calls = {}
    near = {"track.speed": min(scene.track.speed, scene.sonar.ping_rate * RADIUS / SWEPT), "track.pings": SWEPT}
    for count in TARGETS:
        arrays, poses = ready(edit(scene, {**near, "targets": _spheres(scene, count)}), SWEPT)
        calls |= _both("targets in the beam", count, arrays, poses, planes)
    return calls


def _spheres(scene: Scene, count: int) -> list[Mapping[str, Any]]:
    """Spheres athwart the track's start, port and starboard in turn, from 1.2 altitudes to most of the range."""
    heading = np.radians(scene.track.heading)
    out: list[Mapping[str, Any]] = []
    for k, away in enumerate(np.geomspace(1.2 * abs(scene.altitude), 0.9 * scene.sonar.range, count)):
        across = float(away) * (1.0 if k % 2 == 0 else -1.0)
        x, y = scene.track.start[0] - across * np.sin(heading), scene.track.start[1] + across * np.cos(heading)
        height = -scene.seabed.depth + RADIUS
        out.append({"kind": "sphere", "radius": RADIUS, "position": [float(x), float(y), height]})
    return out
