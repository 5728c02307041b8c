"""Picture of an accuracy chart: error against time per ping."""

from __future__ import annotations

from textwrap import wrap
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from insonify.accuracy.charts.measurement import AccuracyMeasurement, AccuracyRow
from insonify.accuracy.charts.method_settings import EMBREE_OWN
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
from insonify.display.style import FAINT, INK, label_axes, make_figure

FLOOR, CEILING = 1e-5, 10.0  # errors beyond these are drawn there
WIDE, HIGH = 5.6, 6.4  # inches of one panel with its margins, and of the whole without notes
LEFT, NAMES = 1.0, 2.75  # inches to the left of the panels and, for the names of the methods, to their right
BELOW, NOTE, LETTERS = 0.95, 0.16, 15.5  # inches below the panels without notes, of a line of one; letters an inch
LONGEST = 24  # letters of a method's name in one line
COUNTED = {"march": "step", "rays": "rays per side", "sweep": "planes", "embree": "rays per side"}


class AccuracyFigure(NamedTuple):
    """Drawn accuracy chart."""

    figure: Figure  # figure with an Agg canvas
    marks: dict[Line2D, list[AccuracyRow]]  # rows that the points of every line stand for, so that one can be picked


def draw_accuracy(chart: AccuracyMeasurement) -> AccuracyFigure:
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


def _draw_panel(axes: Axes, chart: AccuracyMeasurement, targets: bool) -> dict[Line2D, list[AccuracyRow]]:
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


def _limit(grid: list[Axes], chart: AccuracyMeasurement) -> None:
    """Leave room for labels."""
    floors = [max(scene.reference.floor, FLOOR) for scene in chart.scenes.values()]
    heights = [_height(row) for row in chart.rows] + floors
    grid[0].margins(x=0.08)
    grid[0].set_ylim(0.3 * min(heights), 4.0 * max(heights))


def _mark_floor(axes: Axes, chart: AccuracyMeasurement, targets: bool) -> None:
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
