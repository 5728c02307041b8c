"""Speed against accuracy of every method on one scene, measured from start to end on this machine."""

from __future__ import annotations

import csv
import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.accuracy import compare, reference, time_calls
from insonify.kernels.types import Poses, Problem
from insonify.records.atomic import replacing
from insonify.scene import Scene, SceneError
from insonify.simulate import prepare
from insonify.tracers import march, rays, sweep
from insonify.tracers.poses import take

STEPS = (16.0, 4.0, 1.0, 0.5)  # of a march, in cells of the bed
RAYS = (250, 1000, 4000, 16000)
PLANES = (2, 4, 8, 16, 32, 64)
REFERENCE_TOLERANCE = 0.001
RESOLVED = 10.0  # times finer than the smallest error the reference is to be
SECONDS = 12.0  # of timing, after which no further round begins
SUFFIXES = (".png", ".csv")
COLUMNS = ("method", "setting", "microseconds_per_ping", "error_beyond", "error_all_bins", "spread", "machine")


@dataclass(frozen=True)
class Row:
    """One method with one setting.

    Attributes
    ----------
    method : str
        Its name.
    setting : str
        As a person reads it.
    microseconds : float
        Median per ping, both sides, on one thread.
    error_beyond, error_all : float
        Shares of the record: beyond 1.4 times the altitude, and over all bins from the first return.
    spread : float
        Half the distance between the quartiles of the times, as a share of the median.
    """

    method: str
    setting: str
    microseconds: float
    error_beyond: float
    error_all: float
    spread: float


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
        Pings that were traced.
    moved : float
        How far the last doubling of its rays moved the reference; errors below this are not resolved.
    machine : str
        Where and with what it was measured.
    """

    title: str
    rows: tuple[Row, ...]
    pings: int
    moved: float
    machine: str

    def front(self) -> list[Row]:
        """Return the rows that none beats in both time and error, fastest first."""
        front: list[Row] = []
        for row in sorted(self.rows, key=lambda row: (row.microseconds, row.error_beyond)):
            if not front or row.error_beyond < front[-1].error_beyond:
                front.append(row)
        return front

    def save(self, path: str | Path) -> None:
        """Write the chart as a picture (.png) or as a table (.csv).

        Raises
        ------
        SceneError
            If the file's name ends in anything else.
        """
        suffix = Path(path).suffix.lower()
        if suffix not in SUFFIXES:
            raise SceneError(f"output: {Path(path).name!r} names no format that is known; end it in .png or .csv")
        with replacing(path) as beside:
            if suffix == ".csv":
                self._write_table(beside)
            else:
                from insonify.chart_figure import draw

                draw(self).savefig(beside, format="png", dpi=150)

    def _write_table(self, path: Path) -> None:
        with path.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file)
            table.writerow(COLUMNS)
            for row in self.rows:
                numbers = (row.microseconds, row.error_beyond, row.error_all, row.spread)
                table.writerow([row.method, row.setting, *(f"{number:.6g}" for number in numbers), self.machine])


def chart(scene: Scene, *, pings: int = 16) -> Chart:
    """Measure time per ping and error of every method on a scene, on this machine.

    Parameters
    ----------
    scene : Scene
        What to trace.
    pings : int
        Pings to trace, spread evenly over the track.

    Returns
    -------
    Chart

    Raises
    ------
    SceneError
        If there are no pings to trace.
    """
    if pings < 1:
        raise SceneError(f"pings: {pings} is too few; give at least 1")
    simulation = prepare(scene)
    poses = simulation.poses(np.unique(np.linspace(0, scene.track.pings - 1, pings).astype(np.int64)))
    # Methods are compared over one piece of ground: of endless ground that beneath most of the pings.
    places, problem = max(simulation.windows.over(simulation.problem, poses), key=lambda part: poses.x[part[0]].size)
    poses = take(poses, places)
    calls = {(method, setting): call for method, setting, call in _contenders(problem, poses)}
    records = {name: call() for name, call in calls.items()}
    right, moved = reference(problem, poses, tolerance=REFERENCE_TOLERANCE)
    smallest = min(compare(problem, poses, record, right).beyond for record in records.values())
    if moved > smallest / RESOLVED:
        right, moved = reference(problem, poses, tolerance=max(smallest / RESOLVED, REFERENCE_TOLERANCE / RESOLVED))
    errors = {name: compare(problem, poses, record, right) for name, record in records.items()}
    timings = time_calls(calls, seconds=SECONDS)
    count = poses.x.size
    rows = tuple(
        Row(*name, 1e6 * timings[name].median / count, error.beyond, error.all_bins, timings[name].spread)
        for name, error in errors.items()
    )
    return Chart(scene.title, rows, count, moved, machine())


def _contenders(problem: Problem, poses: Poses) -> list[tuple[str, str, Callable[[], NDArray[np.float32]]]]:
    """Every method with its settings, all on one thread."""
    spacing, side = problem.bed.spacing, problem.bins
    out: list[tuple[str, str, Callable[[], Any]]] = []
    for cells in STEPS:
        step = cells * spacing
        out.append(("march", f"{step:.3g} m", partial(march.trace, problem, poses, step=step, rays=side, threads=1)))
    for count in RAYS:
        out.append(("rays", f"{count:,} rays", partial(rays.trace, problem, poses, rays=count, threads=1)))
    for planes in PLANES if problem.half_width > 0.0 else (1,):
        name = f"{planes} plane{'s' * (planes > 1)}"
        out.append(("sweep", name, partial(sweep.trace, problem, poses, planes=planes, threads=1)))
    return out


def machine() -> str:
    """Return the processor, its cores and the versions that a measurement depends on."""
    parts = (
        _processor(),
        f"{os.cpu_count()} cores, one thread used",
        f"Python {platform.python_version()}",
        f"Numba {version('numba')}",
    )
    return ", ".join(parts)


def _processor() -> str:
    """Name of the processor, as well as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
