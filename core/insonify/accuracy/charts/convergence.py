"""How fast every method comes to the truth: error against its step or count."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from insonify.accuracy.charts.contenders import Contender, Record, coarser, marches, rays_of, sweeps
from insonify.accuracy.charts.fit import Fit, fit_power
from insonify.accuracy.charts.machine import machine
from insonify.accuracy.charts.measure import ready
from insonify.accuracy.charts.reference import Reference, prove
from insonify.accuracy.metrics import compare
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene
from insonify.tracers import rays, sweep

STEPS = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125)  # of a march, in cells of the bed
RAYS = tuple(1 << k for k in range(8, 15))
PLANES = (2, 4, 8, 16, 32, 64)
NODES = (8, 4, 2)
FINEST_PLANES = 64
PINGS = 8
PROVING = 150.0  # s of processor time, all cores together


class Point(NamedTuple):
    """One measurement.

    Attributes
    ----------
    series : str
        Method and what is refined.
    size : float
        Step in metres, or count.
    error : float
        Share of the record beyond 1.4 times the altitude.
    resolved : bool
        Whether what it is measured against is fine enough to tell.
    """

    series: str
    size: float
    error: float
    resolved: bool


@dataclass(frozen=True)
class ConvergenceChart:
    """Error against step or count.

    Attributes
    ----------
    title : str
        Of the scene.
    points : tuple of Point
        Series by series, from coarse to fine.
    reference : Reference
        What the exact methods are judged by.
    machine : str
        Where and with what it was measured.
    """

    title: str
    points: tuple[Point, ...]
    reference: Reference
    machine: str

    def fits(self) -> dict[str, Fit]:
        """Fit the order of every series to what is resolved: how the error falls as it is refined."""
        fits = {}
        for series in dict.fromkeys(point.series for point in self.points):
            some = [point for point in self.points if point.series == series and point.resolved]
            fits[series] = fit_power([point.size for point in some], [point.error for point in some])
        return fits

    def save(self, path: str | Path) -> None:
        """Write the chart as a picture (.png, .svg) or as a table (.csv, .json).

        Raises
        ------
        SceneError
            If the file's name ends in anything else.
        """
        from insonify.accuracy.charts.files import save
        from insonify.accuracy.charts.law_figures import draw_convergence
        from insonify.accuracy.charts.tables import convergence_table

        save(path, convergence_table(self), lambda: draw_convergence(self))


def convergence_chart(scene: Scene, *, progress: Callable[[float], None] | None = None) -> ConvergenceChart:
    """Measure error against the step of a march, the number of rays, the number of planes, the spacing of nodes.

    Each series is measured against what it comes to: rays and planes against the reference, the steps of a march
    against as many exact rays, fewer nodes against all of them.

    Parameters
    ----------
    scene : Scene
        What to trace.
    progress : callable, optional
        Called now and then with the share done, from 0 to 1; may raise to stop.

    Returns
    -------
    ConvergenceChart

    Raises
    ------
    SceneError
        If the scene cannot be simulated.
    """
    told = progress or (lambda _: None)
    arrays, poses = ready(scene, PINGS)
    exact = rays_of("rays", arrays, RAYS)
    if arrays.half_width > 0.0 and _sweeps_hear(arrays):
        exact += sweeps("sweep, planes", arrays, PLANES)
    records = [one.trace(poses) for one in exact]
    told(0.2)
    right = prove(arrays, poses, records, seconds=PROVING, progress=lambda share: told(0.2 + 0.6 * share))
    points = [
        Point(one.method, one.size, error, error >= right.floor)
        for one, record in zip(exact, records)
        for error in [compare(arrays, poses, record, right.record).beyond]
    ]
    if not arrays.bounces:
        against = rays.trace(arrays, poses, rays=arrays.bins)
        points += _points("march, step in m", marches(arrays, STEPS), arrays, poses, against)
    if _sweeps_hear(arrays):
        planes = FINEST_PLANES if arrays.half_width > 0.0 else 1
        against = sweep.trace(arrays, poses, planes=planes)
        points += _points("sweep, spacing in m", _coarser(arrays, planes), arrays, poses, against)
    told(1.0)
    return ConvergenceChart(scene.title, tuple(points), right, machine())


def _sweeps_hear(arrays: SceneArrays) -> bool:
    return arrays.water.station.size == 1 and not arrays.bounces


def _coarser(arrays: SceneArrays, planes: int) -> list[Contender]:
    """Sweeps over the bed of fewer and fewer nodes, coarsest first."""
    out = []
    for every in NODES:
        if (bed := coarser(arrays.bed, every)) is not None:
            (one,) = sweeps("sweep", arrays._replace(bed=bed), (planes,))
            out.append(one._replace(size=bed.spacing))
    return out


def _points(series: str, some: Sequence[Contender], arrays: SceneArrays, poses: Poses, against: Record) -> list[Point]:
    """Measure contenders against the limit that they come to, which is exact."""
    return [Point(series, one.size, compare(arrays, poses, one.trace(poses), against).beyond, True) for one in some]
