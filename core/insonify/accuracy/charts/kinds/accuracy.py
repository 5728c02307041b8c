"""Speed against accuracy of every method on one scene, measured from start to end on this machine.

The chart is a table or a figure of the time and the error of every method.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from textwrap import wrap
from time import thread_time
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from insonify.accuracy.charts import method_settings, style
from insonify.accuracy.charts.chart import Chart, ChartTable
from insonify.accuracy.charts.embree import TriangulatedScene, explain_omission
from insonify.accuracy.charts.reference import Reference, refine_reference
from insonify.accuracy.timing import describe_machine, time_calls
from insonify.acoustics.flat_bed import compute_flat_bed_curves
from insonify.arrays import Singles
from insonify.display.normalisation import extend_to_water_column, normalise
from insonify.display.style import FAINT, INK, label_axes, make_figure
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.scene import Scene, SceneError, edit
from insonify.statistics.record_errors import (
    Displacement,
    ErrorParts,
    RecordErrors,
    compare_records,
    measure_displacement,
    split_error,
)
from insonify.tow.poses import take_poses

PINGS = 8
PROVING = 300.0  # s of processor time for a reference, over all cores; without surface paths rays seldom take as much
TIMING = 8.0  # s
SHORTEST_CALL = 0.01  # s that a timed call takes at least; a quick method traces the pings again and again
MOST_PINGS = 512  # pings of a timed call
RAYS_OF_TRIANGLES = 1 << 20
FLOOR, CEILING = 1e-5, 10.0  # errors beyond these are drawn there
WIDE, HIGH = 5.6, 6.8  # inches of one panel with its margins, and of the whole without notes
LEFT, NAMES = 1.0, 2.75  # inches to the left of the panels and, for the names of the methods, to their right
BELOW, NOTE, LETTERS = 0.95, 0.16, 15.5  # inches below the panels without notes, of a line of one; letters an inch
COUNTED = {"march": "step", "rays": "rays per side", "sweep": "planes"}
STRAIGHT = "rays, straight"  # in water that bends sound
FOLDED = "other settings, in the table"
TOLERANCE = 0.03  # the usual one of a plan
RECORD = 512  # pings whose time the upper axis shows
COMPARED_ERROR = 0.02  # error at which the times of methods are compared
TINY = 1e-9  # errors below it count as this


@dataclass(frozen=True)
class AccuracyRow:
    """Time and error of one method with one setting."""

    method: str  # name of the method
    setting: str  # setting as text
    size: float  # the setting as a number: step in metres, rays per side, or planes
    targets: bool  # whether the scene includes its targets
    microseconds: float  # median time per ping, both sides, on one thread
    spread: float  # half the distance between the quartiles of the times, as a share of the median
    errors: RecordErrors  # errors against the reference, as shares of the record
    displacement: Displacement  # displacement of shadows and echoes, in metres

    @property
    def key(self) -> method_settings.SettingKey:
        """Method, setting and targets, which together identify the row."""
        return method_settings.SettingKey(self.method, self.setting, self.targets)

    @property
    def label(self) -> str:
        """Setting without the unit that its method implies."""
        return self.setting.removesuffix("s").removesuffix(" plane").removesuffix(" ray")


# Columns of the table by name, each with its value for a row and the reference of its method.
TABLE_COLUMNS: dict[str, Callable[[AccuracyRow, Reference], object]] = {
    "method": lambda row, _: row.method,
    "setting": lambda row, _: row.setting,
    "targets": lambda row, _: "with" if row.targets else "without",
    "microseconds_per_ping": lambda row, _: row.microseconds,
    "spread": lambda row, _: row.spread,
    "error_beyond": lambda row, _: row.errors.beyond,
    "error_all_bins": lambda row, _: row.errors.all_bins,
    "energy_bias": lambda row, _: row.errors.energy_bias,
    "dark_leakage": lambda row, _: row.errors.dark_leakage,
    "shadow_edge_m": lambda row, _: row.displacement.shadow_edge,
    "echo_position_m": lambda row, _: row.displacement.echo,
    "echoes_lost": lambda row, _: row.displacement.lost,
    "reference_moved": lambda _, reference: reference.moved,
    "reference_moved_all_bins": lambda _, reference: reference.moved_all,
    "resolved": lambda row, reference: "yes" if row.errors.beyond >= reference.floor else "no",
}


class TracedScene(NamedTuple):
    """Arrays, poses and references of a scene with its targets or without them."""

    arrays: SceneArrays  # scene as kernels read it
    poses: Poses  # poses of the n pings that are compared
    reference: Reference  # record by exact rays
    triangles: Reference | None = None  # record by exact rays over a scene of triangles

    def reference_of(self, method: str) -> Reference:
        """Return the reference against which a method's errors are computed."""
        return self.triangles if method == method_settings.EMBREE_OWN and self.triangles is not None else self.reference


@dataclass(frozen=True)
class AccuracyChart(Chart):
    """Error of every method against its time per ping, on one scene."""

    title: str  # title of the scene
    rows: tuple[AccuracyRow, ...]  # all methods and settings
    pings: int  # number of pings that were compared
    machine: str  # processor and versions of the measurement
    # Scene with its targets (``True``) and without (``False``); a scene without targets has only ``False``.
    scenes: Mapping[bool, TracedScene] = field(repr=False)
    records: Mapping[method_settings.SettingKey, Singles] = field(repr=False)  # record of every row
    notes: tuple[str, ...] = ()  # methods that were left out, and why

    def rows_of(self, targets: bool) -> list[AccuracyRow]:
        """Rows of the scene with its targets, or without."""
        return [row for row in self.rows if row.targets == targets]

    def find_front(self, targets: bool) -> list[AccuracyRow]:
        """Pareto front, fastest first: rows with a smaller error than all faster rows."""
        # Differences no greater than the change of the reference by the last doubling of its rays do not count.
        front: list[AccuracyRow] = []
        resolved = self.scenes[targets].reference.moved
        rows = (row for row in self.rows_of(targets) if row.method != method_settings.EMBREE_OWN)
        for row in sorted(rows, key=lambda row: (row.microseconds, row.errors.beyond)):
            if not front or row.errors.beyond < front[-1].errors.beyond - resolved:
                front.append(row)
        return front

    def time_to_error(self, method: str, error: float, targets: bool) -> float:
        """Microseconds per ping after which a method's error falls to a bound, NaN if it does not or is unresolved."""
        # Between two settings the error is a power of the time.
        if error < self.scenes[targets].reference.floor:
            return math.nan
        before: AccuracyRow | None = None
        rows = [row for row in self.rows_of(targets) if row.method == method]
        for row in sorted(rows, key=lambda row: row.microseconds):
            if row.errors.beyond <= error:
                if before is None:
                    return row.microseconds
                fall = math.log(before.errors.beyond / max(row.errors.beyond, TINY))
                share = math.log(before.errors.beyond / error) / fall
                return before.microseconds * (row.microseconds / before.microseconds) ** share
            before = row
        return math.nan

    def fastest_sweep(self, error: float, targets: bool) -> tuple[str, float]:
        """Find the division of segments by which the sweep reaches an error first: method and microseconds per ping."""
        # NaN where none reaches it, or where the reference does not resolve it.
        times = {method: self.time_to_error(method, error, targets) for method in method_settings.SWEEPS}
        return min(times.items(), key=lambda item: math.inf if math.isnan(item[1]) else item[1])

    def describe_speedup(self, targets: bool) -> str:
        """State how much faster than exact rays the sweep reaches an error; empty where either does not reach it."""
        # The sweep divides segments in the way that reaches that error first, as a plan would.
        method, sweep = self.fastest_sweep(COMPARED_ERROR, targets)
        exact = self.time_to_error("rays", COMPARED_ERROR, targets)
        if not exact / sweep > 0.0:
            return ""
        times = f"{exact / sweep:,.0f}" if exact > 10.0 * sweep else f"{exact / sweep:.2g}"
        division = method.removeprefix("sweep").removeprefix(", ")
        how = f"the sweep ({division})" if division else "the sweep"
        bound = style.format_percent(COMPARED_ERROR)
        return f"{bound} in {style.format_time(sweep)} by {how}, in {style.format_time(exact)} by exact rays: × {times}"

    def describe_parts(self) -> tuple[str, ...]:
        """State the errors of bed, shadows and targets apart, of plans and of rays."""
        if len(self.scenes) < 2:
            return ()
        lines = []
        for method in (method_settings.PLAN, "rays"):
            rows = [row for row in self.rows_of(True) if row.method == method]
            if not rows:
                continue
            row = min(rows, key=lambda row: abs(math.log(max(row.errors.beyond, TINY) / COMPARED_ERROR)))
            bare = next((each for each in self.rows_of(False) if each.key == row.key._replace(targets=False)), None)
            bed, shadows, targets = (style.format_percent(part) for part in self.split(row))
            lines.append(
                f"{row.method}, {row.setting}: {style.format_percent(row.errors.beyond)} in "
                f"{style.format_time(row.microseconds)}, of it bed {bed}, shadows {shadows}, targets {targets} "
                "(squares add up)" + (f"; without targets {style.format_percent(bare.errors.beyond)}" if bare else "")
            )
        return tuple(lines)

    def split(self, row: AccuracyRow) -> ErrorParts:
        """Errors of bed, shadows and targets in the record of a row with targets."""
        scene, bare = self.scenes[True], self.scenes[False].reference.record
        reference = scene.reference_of(row.method).record
        return split_error(scene.arrays, scene.poses, self.records[row.key], reference, bare)

    def summarise(self) -> tuple[str, ...]:
        """State how much faster the sweep is, and which methods were left out."""
        which = {False: "without targets: ", True: "with targets: "} if len(self.scenes) > 1 else {}
        speedups = {targets: self.describe_speedup(targets) for targets in sorted(self.scenes)}
        faster = [which.get(targets, "") + line for targets, line in speedups.items() if line]
        return (*faster, *self.describe_parts(), *self.notes)

    def normalise_row(self, row: AccuracyRow) -> tuple[Singles, Singles]:
        """Amplitudes of a row's record and of its reference, relative to a level Lambert bed."""
        scene = self.scenes[row.targets]
        curves = compute_flat_bed_curves(scene.arrays, scene.poses)[:, 0]
        curve = np.array([extend_to_water_column(one) for one in curves])[:, None, :]
        return normalise(self.records[row.key], curve), normalise(scene.reference_of(row.method).record, curve)

    def tabulate(self) -> ChartTable:
        """Lay the rows out with all errors, displacements and the resolution of the reference."""
        best = {row.key for targets in self.scenes for row in self.find_front(targets)}
        facts = {
            "title": self.title,
            "machine": self.machine,
            "pings": self.pings,
            "notes": "; ".join(self.summarise()),
        }
        rows = []
        for row in self.rows:
            reference = self.scenes[row.targets].reference_of(row.method)
            cells = [value(row, reference) for value in TABLE_COLUMNS.values()]
            parts = self.split(row) if row.targets and len(self.scenes) > 1 else (None, None, None)
            rows.append((*cells, *parts, "yes" if row.key in best else "no"))
        parts_of = (f"error_{part}" for part in ErrorParts._fields)
        return ChartTable(facts, (*TABLE_COLUMNS, *parts_of, "best_for_its_time"), rows)

    def draw(self) -> Figure:
        """Draw error against time per ping, with the Pareto front."""
        return _draw_accuracy(self)


def _draw_accuracy(chart: AccuracyChart) -> Figure:
    """Draw error against time per ping and the Pareto front."""
    panels = len(chart.scenes)
    width = LEFT + WIDE * panels + NAMES
    remarks = (*chart.describe_parts(), *chart.notes)
    notes = [line for note in remarks for line in wrap(note, int((width - LEFT) * LETTERS))]
    height = HIGH + NOTE * len(notes)
    figure = make_figure(width, height)
    pings = f"{chart.pings} ping{'s' * (chart.pings != 1)}"
    style.write_headings(
        figure, "Speed against accuracy", f"{chart.title or 'untitled scene'} · {pings}", chart.machine
    )
    grid = figure.subplots(1, panels, sharex=True, sharey=True, squeeze=False)[0]
    bottom = (BELOW + NOTE * len(notes)) / height
    figure.subplots_adjust(LEFT / width, bottom, 1.0 - NAMES / width, 1.0 - 1.65 / height, wspace=0.09)
    figure.text(0.85 / width, 0.36 / height, "\n".join(notes), va="bottom", fontsize=8.5, color=FAINT)
    # Drawn in full: the sweep as a plan divides it, rays, a march, the plan, straight rays.
    sweep, _ = chart.fastest_sweep(COMPARED_ERROR, max(chart.scenes))
    shown = (sweep, "rays", "march", method_settings.PLAN, STRAIGHT)
    for axes, targets in zip(grid, sorted(chart.scenes)):
        _draw_panel(axes, chart, targets, shown)
    floors = [max(scene.reference.floor, FLOOR) for scene in chart.scenes.values()]
    heights = [*map(_height, chart.rows), *floors]
    grid[0].margins(x=0.08)  # room for labels
    grid[0].set_ylim(0.3 * min(heights), 4.0 * max(heights))
    _name_methods(figure, grid)
    for axes, targets in zip(grid, sorted(chart.scenes)):
        # Errors that the reference does not resolve.
        reference = chart.scenes[targets].reference
        axes.axhspan(FLOOR / 10.0, max(reference.floor, FLOOR), color=FAINT, alpha=0.10, linewidth=0, zorder=0)
        doubled = f"doubling to {reference.rays:,} rays per side\n({reference.kind})"
        moved = f"not resolved: {doubled} changed the reference by {style.format_percent(reference.moved)}"
        _write(axes, 0.012, 0.012, moved, FAINT, ha="left", va="bottom")
        _write(axes, 0.988, 0.985, chart.describe_speedup(targets), INK, ha="right", va="top")
        labels = [
            (row.label, row.microseconds, _height(row), style.style_of(row.method)[0])
            for row in chart.rows_of(targets)
            if row.method in shown[:4]
        ]
        style.place_labels(axes, labels)
    label_axes(grid[0], y="error beyond 1.4 × altitude", size=10.5, pad=6)
    return figure


def _draw_panel(axes: Axes, chart: AccuracyChart, targets: bool, shown: tuple[str, ...]) -> None:
    """Draw one scene: the front, then every method's points with a line through them."""
    style.scale_axes(axes, x=style.format_time, y=style.format_percent)
    label_axes(axes, "time per ping, both sides, one thread", size=10.5, pad=6)
    if len(chart.scenes) > 1:
        axes.set_title("with its targets" if targets else "without targets", fontsize=11, color=INK, loc="left", pad=34)
    front = chart.find_front(targets)
    axes.plot(
        [row.microseconds for row in front], [_height(row) for row in front],
        color=INK, linewidth=7.0, alpha=0.10, solid_capstyle="round", solid_joinstyle="round", zorder=1,
        label="best for its time",
    )  # fmt: skip
    axes.axhline(TOLERANCE, color=INK, linewidth=1.0, linestyle=":", zorder=1)
    tolerance = f"tolerance {style.format_percent(TOLERANCE)}"
    axes.annotate(tolerance, (0.012, TOLERANCE), xycoords=("axes fraction", "data"), xytext=(0, 3),
                  textcoords="offset points", fontsize=8.0, color=INK, path_effects=style.OUTLINE)  # fmt: skip
    whole = axes.secondary_xaxis("top", functions=(partial(np.multiply, RECORD), partial(np.multiply, 1.0 / RECORD)))
    whole.xaxis.set_major_formatter(lambda many, _: style.format_time(many))
    label_axes(whole, f"{RECORD} pings", size=9.0, pad=4)
    whole.tick_params(labelsize=9.0, colors=FAINT)
    for method, rows in style.group_by(chart.rows_of(targets), lambda row: row.method).items():
        (_draw_method if method in shown else _draw_folded)(axes, method, rows)


def _draw_folded(axes: Axes, method: str, rows: list[AccuracyRow]) -> None:
    """Draw the settings of a method that answers a special question as small grey marks."""
    axes.plot(
        [row.microseconds for row in rows], [_height(row) for row in rows], linestyle="none", marker=".", markersize=5,
        color=FAINT, alpha=0.7, zorder=2, label=FOLDED,
    )  # fmt: skip


def _draw_method(axes: Axes, method: str, rows: list[AccuracyRow]) -> None:
    """Draw a line through the settings of a method and a mark for each."""
    x, y = [row.microseconds for row in rows], [_height(row) for row in rows]
    colour, mark = style.style_of(method)
    family, _, variant = method.partition(", ")
    axes.errorbar(
        x, y, xerr=[row.spread * row.microseconds for row in rows], fmt="none", ecolor=colour, elinewidth=1.0, zorder=2
    )
    axes.plot(
        x, y, color=colour, linewidth=1.2, marker="*" if method == method_settings.PLAN else mark,
        markersize=11.0 if method == method_settings.PLAN else 6.5, markeredgecolor="white", zorder=3,
        label=f"{family}{variant and ', '}{variant}\n({COUNTED[family]})" if family in COUNTED else method,
    )  # fmt: skip


def _name_methods(figure: Figure, grid: list[Axes]) -> None:
    """Write the legend of all panels to their right, each method once."""
    named: dict[str, Any] = {}
    for axes in grid:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            named.setdefault(label, handle)
    place = grid[-1].get_position()
    named[FOLDED] = named.pop(FOLDED, None)
    named = {label: handle for label, handle in named.items() if handle is not None}
    figure.legend(
        list(named.values()), list(named), loc="upper left", bbox_to_anchor=(place.x1 + 0.003, place.y1), frameon=False,
        fontsize=9, labelcolor=INK, handlelength=1.8, labelspacing=0.9,
    )  # fmt: skip


def _write(axes: Axes, x: float, y: float, text: str, colour: str, **align: Any) -> None:
    """Write a remark at a place of a panel, in shares of its width and height."""
    axes.text(x, y, text, transform=axes.transAxes, fontsize=8.0, color=colour, path_effects=style.OUTLINE, **align)


def _height(row: AccuracyRow) -> float:
    return min(max(row.errors.beyond, FLOOR), CEILING)


def measure_chart(
    scene: Scene, *, pings: int = PINGS, progress: Callable[[float], None] | None = None
) -> AccuracyChart:
    """Measure time per ping and error of every method on a scene, on this machine.

    Parameters
    ----------
    scene : Scene
        Scene to trace; one with targets is also traced without them.
    pings : int
        Number of pings to compare, spread evenly over the track.
    progress : callable, optional
        Called now and then with the completed share, from 0 to 1; may raise to stop.

    Returns
    -------
    AccuracyChart

    Raises
    ------
    SceneError
        If there are no pings to trace, or the scene cannot be simulated.
    """
    if pings < 1:
        raise SceneError(f"pings: {pings} is too few; give at least 1")
    scenes = {False: edit(scene, {"targets": []})} if scene.targets else {}
    scenes |= {bool(scene.targets): scene}
    rows: list[AccuracyRow] = []
    traced: dict[bool, TracedScene] = {}
    records: dict[method_settings.SettingKey, Singles] = {}
    for number, (targets, one) in enumerate(scenes.items()):

        def share(done: float, before: int = number) -> None:
            if progress is not None:
                progress((before + done) / len(scenes))

        arrays, poses = method_settings.pack_for_chart(one, pings)
        measured, traced[targets], found = _measure(targets, one, arrays, poses, share)
        rows += measured
        records |= found
    notes = tuple(dict.fromkeys(_describe_triangles(targets, scene) for targets, scene in traced.items()))
    count = traced[False].poses.x.size
    return AccuracyChart(scene.title, tuple(rows), count, describe_machine(), traced, records, notes)


chart = measure_chart  # the public name of the package


def _describe_triangles(targets: bool, scene: TracedScene) -> str:
    """State how far a scene of triangles differs from the curved surfaces, or why Embree is left out."""
    if scene.triangles is None:
        return explain_omission(scene.arrays, scene.poses)
    apart = compare_records(scene.arrays, scene.poses, scene.triangles.record, scene.reference.record).beyond
    return (
        f"embree: with {scene.triangles.rays:,} rays per side {'bed and targets of' if targets else 'the bed of'} "
        f"triangles differ{'' if targets else 's'} from the exact surfaces by {100.0 * apart:.2g} %; the rest of its "
        "error is due to the number of rays"
    )


def _measure(
    targets: bool, whole: Scene, arrays: SceneArrays, poses: Poses, progress: Callable[[float], None]
) -> tuple[list[AccuracyRow], TracedScene, dict[method_settings.SettingKey, Singles]]:
    """Trace all methods, refine the reference until it resolves their errors, time them and compare."""
    named = {
        method_settings.SettingKey(one.method, one.setting, targets): one
        for one in (*method_settings.list_settings(arrays, poses), *method_settings.plan_settings(whole))
    }
    records: dict[method_settings.SettingKey, Singles] = {}
    for number, (key, one) in enumerate(named.items()):
        progress(0.2 * number / len(named))
        records[key] = one.trace(poses)
    reference = refine_reference(
        arrays, poses, list(records.values()), seconds=PROVING, progress=lambda share: progress(0.2 + 0.5 * share)
    )
    scene = TracedScene(arrays, poses, reference, _trace_triangles(arrays, poses, lambda: progress(0.7)))
    timed = {}
    for key, one in named.items():
        progress(0.7)
        # The poses are traced often enough to be timed.
        began = thread_time()
        one.trace(poses)
        times = math.ceil(SHORTEST_CALL / max(thread_time() - began, 1e-6))
        many = take_poses(poses, np.tile(np.arange(poses.x.size), max(min(times, MOST_PINGS // poses.x.size), 1)))
        timed[key] = partial(one.trace, many)
    timings = time_calls(timed, seconds=TIMING, clock=thread_time, progress=lambda share: progress(0.7 + 0.3 * share))
    rows = []
    for key, one in named.items():
        per_ping = 1e6 * timings[key].median / timed[key].args[-1].x.size
        for method in (
            (one.method, method_settings.EMBREE_OWN) if one.method == method_settings.EMBREE else (one.method,)
        ):
            records[key._replace(method=method)] = records[key]
            pair = records[key], scene.reference_of(method).record
            errors, moved = compare_records(arrays, poses, *pair), measure_displacement(arrays, poses, *pair)
            spread = timings[key].spread
            rows.append(AccuracyRow(method, one.setting, one.size, targets, per_ping, spread, errors, moved))
    return sorted(rows, key=lambda row: row.method == method_settings.EMBREE_OWN), scene, records


def _trace_triangles(arrays: SceneArrays, poses: Poses, report: Callable[[], None]) -> Reference | None:
    """Trace a scene of triangles, and the change of its record when the rays are doubled; None without Embree."""
    if explain_omission(arrays, poses):
        return None
    scene = TriangulatedScene(arrays, poses)

    def trace(rays: int) -> Singles:
        records = []
        for ping in range(poses.x.size):
            records.append(scene.trace(take_poses(poses, slice(ping, ping + 1)), rays=rays))
            report()
        return np.concatenate(records)

    half, whole = trace(RAYS_OF_TRIANGLES // 2), trace(RAYS_OF_TRIANGLES)
    moved = compare_records(arrays, poses, half, whole)
    return Reference(whole, moved.beyond, RAYS_OF_TRIANGLES, moved.all_bins)
