"""Accuracy chart: time and error of every method on one scene, as a table and as a figure."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from insonify.accuracy.charts.chart import Chart, ChartTable
from insonify.accuracy.charts.method_settings import EMBREE_OWN, SWEEPS, Record, SettingKey
from insonify.accuracy.charts.reference import Reference
from insonify.accuracy.charts.style import (
    OUTLINE,
    format_percent,
    format_time,
    get_colour,
    get_mark,
    place_labels,
    scale_axes,
    write_headings,
)
from insonify.acoustics.flat_bed import compute_flat_bed_curves
from insonify.display.normalisation import extend_to_water_column, normalise
from insonify.display.style import FAINT, INK, label_axes, make_figure
from insonify.kernels.common.types import Poses, SceneArrays
from insonify.statistics.displacement import Displacement
from insonify.statistics.record_errors import RecordErrors

FLOOR, CEILING = 1e-5, 10.0  # errors beyond these are drawn there
WIDE, HIGH = 5.6, 6.4  # inches of one panel with its margins, and of the whole without notes
LEFT, NAMES = 1.0, 2.75  # inches to the left of the panels and, for the names of the methods, to their right
BELOW, NOTE, LETTERS = 0.95, 0.16, 15.5  # inches below the panels without notes, of a line of one; letters an inch
LONGEST = 24  # letters of a method's name in one line
COUNTED = {"march": "step", "rays": "rays per side", "sweep": "planes", "embree": "rays per side"}
COMPARED_ERROR = 0.02  # error at which the times of methods are compared
TINY = 1e-9  # errors below it count as this
COLUMNS = (
    "method",
    "setting",
    "targets",
    "microseconds_per_ping",
    "spread",
    "error_beyond",
    "error_all_bins",
    "energy_bias",
    "dark_leakage",
    "shadow_edge_m",
    "echo_position_m",
    "echoes_lost",
    "reference_moved",
    "reference_moved_all_bins",
    "resolved",
    "best_for_its_time",
)


@dataclass(frozen=True)
class AccuracyRow:
    """Time and error of one method with one setting."""

    method: str  # name of the method
    setting: str  # setting as text
    size: float  # the setting as a number: step in metres, rays per side, or planes
    targets: bool  # whether the scene holds its targets
    microseconds: float  # median time per ping, both sides, on one thread
    spread: float  # half the distance between the quartiles of the times, as a share of the median
    errors: RecordErrors  # errors against the reference, as shares of the record
    displacement: Displacement  # displacement of shadows and echoes, in metres

    @property
    def key(self) -> SettingKey:
        """Method, setting and targets, which together identify the row."""
        return SettingKey(self.method, self.setting, self.targets)

    @property
    def label(self) -> str:
        """Setting without the unit that its method implies."""
        return self.setting.removesuffix("s").removesuffix(" plane").removesuffix(" ray")


class TracedScene(NamedTuple):
    """Arrays, poses and references of a scene with its targets or without them."""

    arrays: SceneArrays  # scene as kernels read it
    poses: Poses  # poses of the n pings that are compared
    reference: Reference  # record by exact rays
    triangles: Reference | None = None  # record by exact rays over a scene of triangles

    def reference_of(self, method: str) -> Reference:
        """Return the reference against which a method's errors are computed."""
        return self.triangles if method == EMBREE_OWN and self.triangles is not None else self.reference


@dataclass(frozen=True)
class AccuracyChart(Chart):
    """Error of every method against its time per ping, on one scene."""

    title: str  # title of the scene
    rows: tuple[AccuracyRow, ...]  # all methods and settings
    pings: int  # number of pings that were compared
    machine: str  # processor and versions of the measurement
    # Scene with its targets (``True``) and without; a scene that has none has only ``False``.
    scenes: Mapping[bool, TracedScene] = field(repr=False)
    records: Mapping[SettingKey, Record] = field(repr=False)  # record of every row
    notes: tuple[str, ...] = ()  # methods that were left out, and why

    def rows_of(self, targets: bool) -> list[AccuracyRow]:
        """Rows of the scene with its targets, or without."""
        return [row for row in self.rows if row.targets == targets]

    def find_front(self, targets: bool) -> list[AccuracyRow]:
        """Pareto front, fastest first: rows with a smaller error than all faster rows.

        Less by more than the last doubling of the rays changed the reference; a smaller difference is not resolved.
        """
        front: list[AccuracyRow] = []
        resolved = self.scenes[targets].reference.moved
        rows = (row for row in self.rows_of(targets) if row.method != EMBREE_OWN)
        for row in sorted(rows, key=lambda row: (row.microseconds, row.errors.beyond)):
            if not front or row.errors.beyond < front[-1].errors.beyond - resolved:
                front.append(row)
        return front

    def time_to_error(self, method: str, error: float, targets: bool) -> float:
        """Microseconds per ping after which a method's error falls to a bound.

        Between two settings the error is a power of the time. NaN where no setting reaches the bound, or where the
        reference does not resolve it.
        """
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
        """Find the division of segments by which the sweep reaches an error first: method and microseconds per ping.

        NaN where none reaches it, or where the reference does not resolve it.
        """
        times = {method: self.time_to_error(method, error, targets) for method in SWEEPS}
        return min(times.items(), key=lambda item: math.inf if math.isnan(item[1]) else item[1])

    def describe_speedup(self, targets: bool) -> str:
        """State how much faster the sweep reaches an error than exact rays; empty where either does not reach it.

        The sweep divides segments as far as serves it best at that error, as a plan lets it.
        """
        method, sweep = self.fastest_sweep(COMPARED_ERROR, targets)
        exact = self.time_to_error("rays", COMPARED_ERROR, targets)
        if not exact / sweep > 0.0:
            return ""
        times = f"{exact / sweep:,.0f}" if exact > 10.0 * sweep else f"{exact / sweep:.2g}"
        division = method.removeprefix("sweep").removeprefix(", ")
        how = f"the sweep ({division})" if division else "the sweep"
        bound = format_percent(COMPARED_ERROR)
        return f"{bound} in {format_time(sweep)} by {how}, in {format_time(exact)} by exact rays: × {times}"

    def summarise(self) -> tuple[str, ...]:
        """State how much faster the sweep is, and which methods were left out."""
        which = {False: "without targets: ", True: "with targets: "} if len(self.scenes) > 1 else {}
        speedups = {targets: self.describe_speedup(targets) for targets in sorted(self.scenes)}
        return (*(which.get(targets, "") + line for targets, line in speedups.items() if line), *self.notes)

    def normalise_row(self, row: AccuracyRow) -> tuple[Record, Record]:
        """Amplitudes of a row's record and of its reference, relative to a level Lambert bed."""
        scene = self.scenes[row.targets]
        curves = compute_flat_bed_curves(scene.arrays, scene.poses)[:, 0]
        curve = np.array([extend_to_water_column(one) for one in curves])[:, None, :]
        return normalise(self.records[row.key], curve), normalise(scene.reference_of(row.method).record, curve)

    def tabulate(self) -> ChartTable:
        """Lay the rows out with all errors, displacements and the resolution of the reference."""
        best = {row.key for targets in self.scenes for row in self.find_front(targets)}
        facts = {"title": self.title, "machine": self.machine, "pings": self.pings}
        facts["notes"] = "; ".join(self.summarise())
        return ChartTable(facts, COLUMNS, [self._cells(row, row.key in best) for row in self.rows])

    def _cells(self, row: AccuracyRow, best: bool) -> tuple[object, ...]:
        reference = self.scenes[row.targets].reference_of(row.method)
        errors, moved = row.errors, row.displacement
        return (
            row.method,
            row.setting,
            "with" if row.targets else "without",
            row.microseconds,
            row.spread,
            errors.beyond,
            errors.all_bins,
            errors.energy_bias,
            errors.dark_leakage,
            moved.shadow_edge,
            moved.echo,
            moved.lost,
            reference.moved,
            reference.moved_all,
            "yes" if errors.beyond >= reference.floor else "no",
            "yes" if best else "no",
        )

    def draw(self) -> Figure:
        """Draw error against time per ping, with the Pareto front."""
        return draw_accuracy(self).figure


class AccuracyFigure(NamedTuple):
    """Drawn accuracy chart."""

    figure: Figure  # figure with an Agg canvas
    marks: dict[Line2D, list[AccuracyRow]]  # rows that the points of every line stand for, so that one can be picked


def draw_accuracy(chart: AccuracyChart) -> AccuracyFigure:
    """Draw error against time per ping and the Pareto front, a panel with targets and one without."""
    panels = len(chart.scenes)
    width = LEFT + WIDE * panels + NAMES
    notes = [line for note in chart.notes for line in wrap(note, int((width - LEFT) * LETTERS))]
    height = HIGH + NOTE * len(notes)
    figure = make_figure(width, height)
    pings = f"{chart.pings} ping{'s' * (chart.pings != 1)}"
    write_headings(figure, "Speed against accuracy", f"{chart.title or 'untitled scene'} · {pings}", chart.machine)
    grid = figure.subplots(1, panels, sharex=True, sharey=True, squeeze=False)[0]
    bottom = (BELOW + NOTE * len(notes)) / height
    figure.subplots_adjust(LEFT / width, bottom, 1.0 - NAMES / width, 1.0 - 1.25 / height, wspace=0.09)
    figure.text(0.85 / width, 0.36 / height, "\n".join(notes), va="bottom", fontsize=8.5, color=FAINT)
    marks: dict[Line2D, list[AccuracyRow]] = {}
    for axes, targets in zip(grid, sorted(chart.scenes)):
        marks |= _draw_panel(axes, chart, targets)
    _limit(grid, chart)
    _name_methods(figure, grid)
    for axes, targets in zip(grid, sorted(chart.scenes)):
        _mark_floor(axes, chart, targets)
        _write(axes, 0.988, 0.985, chart.describe_speedup(targets), INK, ha="right", va="top")
        labels = [
            (row.label, row.microseconds, _height(row), get_colour(row.method))
            for row in chart.rows_of(targets)
            if row.method != EMBREE_OWN
        ]
        place_labels(axes, labels)
    label_axes(grid[0], y="error beyond 1.4 × altitude", size=10.5, pad=6)
    return AccuracyFigure(figure, marks)


def _draw_panel(axes: Axes, chart: AccuracyChart, targets: bool) -> dict[Line2D, list[AccuracyRow]]:
    """Draw one scene: the front, then every method's points with a line through them."""
    scale_axes(axes, x=format_time, y=format_percent)
    label_axes(axes, "time per ping, both sides, one thread", size=10.5, pad=6)
    if len(chart.scenes) > 1:
        axes.set_title("with its targets" if targets else "without targets", fontsize=11, color=INK, loc="left")
    front = chart.find_front(targets)
    axes.plot(
        [row.microseconds for row in front], [_height(row) for row in front],
        color=INK, linewidth=7.0, alpha=0.10, solid_capstyle="round", solid_joinstyle="round", zorder=1,
        label="best for its time",
    )  # fmt: skip
    rows = chart.rows_of(targets)
    marks: dict[Line2D, list[AccuracyRow]] = {}
    for method in dict.fromkeys(row.method for row in rows):
        of_method = [row for row in rows if row.method == method]
        marks[_draw_method(axes, method, of_method)] = of_method
    return marks


def _draw_method(axes: Axes, method: str, rows: list[AccuracyRow]) -> Line2D:
    """Draw a line through the settings of a method and a mark for each."""
    x, y, colour = [row.microseconds for row in rows], [_height(row) for row in rows], get_colour(method)
    axes.errorbar(
        x, y, xerr=[row.spread * row.microseconds for row in rows], fmt="none", ecolor=colour, elinewidth=1.0, zorder=2
    )
    (line,) = axes.plot(
        x, y, color=colour, linewidth=1.2, linestyle="--" if "," in method else "-",
        marker=get_mark(method), markersize=6.5, markeredgecolor="white", zorder=3,
        label=_name_method(method), picker=5,
    )  # fmt: skip
    return line


def _name_method(method: str) -> str:
    """Name of a method with the unit of its labels; a long variant in two lines."""
    family, _, variant = method.partition(", ")
    if not variant:
        return f"{family} ({COUNTED[family]})"
    return method if len(method) <= LONGEST else f"{family},\n{variant}"


def _name_methods(figure: Figure, grid: list[Axes]) -> None:
    """Write the legend of all panels to their right, each method once."""
    named: dict[str, Any] = {}
    for axes in grid:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            named.setdefault(label, handle)
    place = grid[-1].get_position()
    figure.legend(
        list(named.values()), list(named), loc="upper left", bbox_to_anchor=(place.x1 + 0.003, place.y1), frameon=False,
        fontsize=9, labelcolor=INK, handlelength=1.8, labelspacing=0.9,
    )  # fmt: skip


def _limit(grid: list[Axes], chart: AccuracyChart) -> None:
    """Leave room for labels."""
    floors = [max(scene.reference.floor, FLOOR) for scene in chart.scenes.values()]
    heights = [_height(row) for row in chart.rows] + floors
    grid[0].margins(x=0.08)
    grid[0].set_ylim(0.3 * min(heights), 4.0 * max(heights))


def _mark_floor(axes: Axes, chart: AccuracyChart, targets: bool) -> None:
    """Shade the errors that the reference does not resolve."""
    reference = chart.scenes[targets].reference
    axes.axhspan(FLOOR / 10.0, max(reference.floor, FLOOR), color=FAINT, alpha=0.10, linewidth=0, zorder=0)
    doubled = f"doubling to {reference.rays:,} rays per side\n({reference.kind})"
    text = f"not resolved: {doubled} changed the reference by {format_percent(reference.moved)}"
    _write(axes, 0.012, 0.012, text, FAINT, ha="left", va="bottom")


def _write(axes: Axes, x: float, y: float, text: str, colour: str, **align: Any) -> None:
    """Write a remark at a place of a panel, in shares of its width and height."""
    axes.text(x, y, text, transform=axes.transAxes, fontsize=8.0, color=colour, path_effects=OUTLINE, **align)


def _height(row: AccuracyRow) -> float:
    return min(max(row.errors.beyond, FLOOR), CEILING)
