"""Convergence of every method: error against its step, or its number of rays, planes or nodes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from insonify.accuracy.charts import method_settings, style
from insonify.accuracy.charts.chart import Chart, ChartTable
from insonify.accuracy.charts.reference import Reference, refine_reference
from insonify.accuracy.timing import describe_machine
from insonify.arrays import Singles
from insonify.display.style import FAINT, label_axes
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene
from insonify.statistics.record_errors import compare_records
from insonify.tracers import rays, sweep

MARCH_STEPS = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125)  # step of a march, in cells of the bed
RAYS = tuple(1 << k for k in range(8, 15))
PLANES = (2, 4, 8, 16, 32, 64)
NODES = (8, 4, 2)
FINEST_PLANES = 64
PINGS = 8
PROVING = 150.0  # s of processor time, over all cores
TABLE_COLUMNS = ("series", "size", "error_beyond", "resolved", "exponent", "exponent_spread")
LIMITS = {  # of series that do not converge to the reference
    "march, step in m": "error against as many exact rays",
    "sweep, spacing in m": "error against all nodes of the bed",
}
SYMBOLS = {"march, step in m": "step", "sweep, spacing in m": "spacing"}


class ConvergencePoint(NamedTuple):
    """Error of one series at one size."""

    series: str  # method and refined quantity
    size: float  # step or spacing in metres, or count
    error: float  # share of the record beyond 1.4 times the altitude
    resolved: bool  # whether the reference is fine enough to resolve the error


@dataclass(frozen=True)
class ConvergenceChart(Chart):
    """Error against step or count."""

    title: str  # title of the scene
    points: tuple[ConvergencePoint, ...]  # series by series, from coarse to fine
    reference: Reference  # reference of rays and planes
    machine: str  # processor and versions of the measurement

    def group(self) -> dict[str, list[ConvergencePoint]]:
        """Points by series."""
        return style.group_by(self.points, lambda point: point.series)

    def fits(self) -> dict[str, style.PowerLawFit]:
        """Order of convergence of every series, fitted to the points that are resolved."""
        resolved = {series: [point for point in points if point.resolved] for series, points in self.group().items()}
        return {
            series: style.fit_power_law([point.size for point in points], [point.error for point in points])
            for series, points in resolved.items()
        }

    def tabulate(self) -> ChartTable:
        """Lay the points out as rows, each with the order of its series."""
        fits = self.fits()
        rows = [
            (point.series, point.size, point.error, "yes" if point.resolved else "no", *fits[point.series][:2])
            for point in self.points
        ]
        facts = {"title": self.title, "machine": self.machine, "reference_moved": self.reference.moved}
        return ChartTable(facts, TABLE_COLUMNS, rows)

    def draw(self) -> Figure:
        """Draw error against step or count, a panel for each series, with the fitted orders."""
        groups = self.group()
        figure, panels = style.lay_out_panels(len(groups), 2)
        remark = f"{self.title or 'untitled scene'} · hollow: not resolved by the reference, not fitted"
        style.write_headings(figure, "Convergence", remark, self.machine)
        fits = self.fits()
        for axes, (series, points) in zip(panels, groups.items()):
            self._draw_panel(axes, series, [point for point in points if point.error > 0.0], fits[series])
        return figure

    def _draw_panel(self, axes: Axes, series: str, points: list[ConvergencePoint], fit: style.PowerLawFit) -> None:
        style.scale_axes(axes, x=style.format_count, y=style.format_percent)
        method, _, what = series.partition(", ")
        colour, mark = style.style_of(method)
        label_axes(axes, what or "rays per side")
        axes.set_title(LIMITS.get(series, "error against the reference"), fontsize=9.5, color=FAINT, loc="left")
        filled, hollow = ([point for point in points if point.resolved is resolved] for resolved in (True, False))
        x, y = [point.size for point in filled], [point.error for point in filled]
        style.draw_series(axes, method, x, y, fit, SYMBOLS.get(series, "count"))
        axes.plot(
            [point.size for point in hollow], [point.error for point in hollow], linestyle="none", markersize=6.5,
            marker=mark, markerfacecolor="white", markeredgecolor=colour,
        )  # fmt: skip
        if series in SYMBOLS:
            axes.invert_xaxis()
        else:
            axes.axhspan(1e-9, self.reference.floor, color=FAINT, alpha=0.10, linewidth=0, zorder=0)
        axes.set_ylim(0.5 * min(point.error for point in points), 2.5 * max(point.error for point in points))
        style.finish_panel(axes)


def measure_chart(scene: Scene, *, progress: Callable[[float], None] | None = None) -> ConvergenceChart:
    """Measure error against the step of a march, the number of rays or planes, and the spacing of nodes.

    Each series is compared with its limit: rays and planes with the reference, the steps of a march with as many exact
    rays, fewer nodes with all nodes.
    """
    report = progress or (lambda _: None)
    arrays, poses = method_settings.pack_for_chart(scene, PINGS)
    exact = method_settings.ray_settings("rays", arrays, RAYS)
    if arrays.half_width > 0.0 and _can_sweep(arrays):
        exact += method_settings.sweep_settings("sweep, planes", arrays, PLANES)
    records = [one.trace(poses) for one in exact]
    report(0.2)
    right = refine_reference(arrays, poses, records, seconds=PROVING, progress=lambda share: report(0.2 + 0.6 * share))
    points = [
        ConvergencePoint(one.method, one.size, error, error >= right.floor)
        for one, record in zip(exact, records)
        for error in [compare_records(arrays, poses, record, right.record).beyond]
    ]
    if not arrays.bounces:
        against = rays.trace(arrays, poses, rays=arrays.bins)
        marches = method_settings.march_settings(arrays, MARCH_STEPS)
        points += _points("march, step in m", marches, arrays, poses, against)
    if _can_sweep(arrays):
        planes = FINEST_PLANES if arrays.half_width > 0.0 else 1
        against = sweep.trace(arrays, poses, planes=planes)
        points += _points("sweep, spacing in m", _coarser(arrays, planes), arrays, poses, against)
    report(1.0)
    return ConvergenceChart(scene.title, tuple(points), right, describe_machine())


def _can_sweep(arrays: SceneArrays) -> bool:
    """Whether the sweep traces the scene: water that varies with depth alone, first echoes."""
    return arrays.water.station.size == 1 and not arrays.bounces


def _coarser(arrays: SceneArrays, planes: int) -> list[method_settings.MethodSetting]:
    """Sweeps over the bed with fewer nodes, coarsest first."""
    out = []
    for every in NODES:
        if (bed := method_settings.coarsen_bed(arrays.bed, every)) is not None:
            (one,) = method_settings.sweep_settings("sweep", arrays._replace(bed=bed), (planes,))
            out.append(one._replace(size=bed.spacing))
    return out


def _points(
    series: str, some: Sequence[method_settings.MethodSetting], arrays: SceneArrays, poses: Poses, against: Singles
) -> list[ConvergencePoint]:
    """Errors of some settings against their exact limit."""
    return [
        ConvergencePoint(series, one.size, compare_records(arrays, poses, one.trace(poses), against).beyond, True)
        for one in some
    ]
