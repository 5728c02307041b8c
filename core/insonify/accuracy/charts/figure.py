"""The chart of accuracy as a picture."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from insonify.accuracy.charts.contenders import EMBREE_OWN
from insonify.accuracy.charts.style import (
    FAINT,
    INK,
    OUTLINE,
    as_percent,
    as_time,
    colour_of,
    mark_of,
    place_labels,
    scale_axes,
    write_headings,
)

if TYPE_CHECKING:
    from insonify.accuracy.charts.measure import Chart, Row

FLOOR = 1e-5  # errors below it are drawn there
CEILING = 10.0  # and errors above it there
WIDE, HIGH = 5.6, 6.4  # inches of one panel with its margins, and of the whole
LEFT, NAMES = 1.0, 2.75  # inches to the left of the panels and, for the names of the methods, to their right
COUNTED = {"march": "step", "rays": "rays a side", "sweep": "planes", "embree": "rays a side"}


class Drawing(NamedTuple):
    """A chart drawn.

    Attributes
    ----------
    figure : Figure
        With an Agg canvas.
    marks : dict of Line2D to list of Row
        What the points of every line stand for, so that one may be picked.
    """

    figure: Figure
    marks: dict[Line2D, list[Row]]


def draw(chart: Chart) -> Drawing:
    """Draw error against time per ping, with targets and without, each with the front of the best.

    Parameters
    ----------
    chart : Chart
        What was measured.

    Returns
    -------
    Drawing
    """
    panels = len(chart.cases)
    figure = Figure(figsize=(LEFT + WIDE * panels + NAMES, HIGH), facecolor="white")
    FigureCanvasAgg(figure)
    write_headings(figure, "Speed against accuracy", _told(chart), chart.machine)
    grid = figure.subplots(1, panels, sharex=True, sharey=True, squeeze=False)[0]
    width = figure.get_size_inches()[0]
    figure.subplots_adjust(LEFT / width, 0.95 / HIGH, 1.0 - NAMES / width, 1.0 - 1.25 / HIGH, wspace=0.09)
    marks: dict[Line2D, list[Row]] = {}
    for axes, targets in zip(grid, sorted(chart.cases)):
        marks |= _panel(axes, chart, targets)
    _limit(grid, chart)
    _name(figure, grid, chart.notes)
    for axes, targets in zip(grid, sorted(chart.cases)):
        _floor(axes, chart, targets)
        _lead(axes, chart, targets)
        rows = [row for row in chart.rows if row.targets == targets]
        labels = [
            (row.label, row.microseconds, _height(row), colour_of(row.method))
            for row in rows
            if row.method != EMBREE_OWN
        ]
        place_labels(axes, labels)
    grid[0].set_ylabel("error beyond 1.4 × altitude", fontsize=10.5, color=INK, labelpad=6)
    return Drawing(figure, marks)


def _told(chart: Chart) -> str:
    pings = f"{chart.pings} ping{'s' * (chart.pings != 1)}"
    return f"{chart.title or 'untitled scene'} · {pings}"


def _panel(axes: Axes, chart: Chart, targets: bool) -> dict[Line2D, list[Row]]:
    """One scene: the front, then every method's points with a line through them."""
    scale_axes(axes, x=as_time, y=as_percent)
    axes.set_xlabel("time per ping, both sides, one thread", fontsize=10.5, color=INK, labelpad=6)
    if len(chart.cases) > 1:
        axes.set_title("with its targets" if targets else "without targets", fontsize=11, color=INK, loc="left")
    front = chart.front(targets)
    axes.plot(
        [row.microseconds for row in front], [_height(row) for row in front],
        color=INK, linewidth=7.0, alpha=0.10, solid_capstyle="round", solid_joinstyle="round", zorder=1,
        label="best for its time",
    )  # fmt: skip
    marks: dict[Line2D, list[Row]] = {}
    for method in dict.fromkeys(row.method for row in chart.rows if row.targets == targets):
        rows = [row for row in chart.rows if row.targets == targets and row.method == method]
        marks[_points(axes, method, rows)] = rows
    return marks


def _points(axes: Axes, method: str, rows: list[Row]) -> Line2D:
    """One method: a line through its settings and a mark for each."""
    x, y, colour = [row.microseconds for row in rows], [_height(row) for row in rows], colour_of(method)
    axes.errorbar(
        x, y, xerr=[row.spread * row.microseconds for row in rows], fmt="none", ecolor=colour, elinewidth=1.0, zorder=2
    )
    (line,) = axes.plot(
        x, y, color=colour, linewidth=1.2, linestyle="--" if "," in method else "-",
        marker=mark_of(method), markersize=6.5, markeredgecolor="white", zorder=3,
        label=_named(method), picker=5,
    )  # fmt: skip
    return line


def _named(method: str) -> str:
    """Tell what a method's labels count; of a family's others in a line more what tells them apart."""
    family, _, rest = method.partition(", ")
    return f"{family},\n{rest}" if rest else f"{family} ({COUNTED[family]})"


def _name(figure: Figure, grid: list[Axes], notes: tuple[str, ...]) -> None:
    """Name the methods of all panels to their right, each once, and below them what there is to note."""
    named: dict[str, Any] = {}
    for axes in grid:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            named.setdefault(label, handle)
    place = grid[-1].get_position()
    figure.legend(
        list(named.values()), list(named), loc="upper left", bbox_to_anchor=(place.x1 + 0.003, place.y1), frameon=False,
        fontsize=9, labelcolor=INK, handlelength=1.8, labelspacing=0.9,
    )  # fmt: skip
    told = "\n\n".join(fill(note, 40) for note in notes)
    left = place.x1 + 0.15 / figure.get_size_inches()[0]
    figure.text(left, place.y0, told, ha="left", va="bottom", fontsize=8.0, color=FAINT)


def _limit(grid: list[Axes], chart: Chart) -> None:
    """Leave room for labels."""
    heights = [_height(row) for row in chart.rows] + [max(case.reference.floor, FLOOR) for case in chart.cases.values()]
    grid[0].margins(x=0.08)
    grid[0].set_ylim(0.5 * min(heights), 4.0 * max(heights))


def _floor(axes: Axes, chart: Chart, targets: bool) -> None:
    """Mark the error below which the reference cannot tell."""
    reference = chart.cases[targets].reference
    low, moved = max(reference.floor, FLOOR), as_percent(reference.moved)
    axes.axhspan(FLOOR / 10.0, low, color=FAINT, alpha=0.10, linewidth=0, zorder=0)
    axes.text(
        0.012, 0.012, f"not resolved: doubling to {reference.rays:,} rays a side moved the reference {moved}",
        transform=axes.transAxes, ha="left", va="bottom", fontsize=8.0, color=FAINT, path_effects=OUTLINE,
    )  # fmt: skip


def _lead(axes: Axes, chart: Chart, targets: bool) -> None:
    """Tell how much sooner the sweep is near the truth."""
    axes.text(
        0.988, 0.985, chart.lead(targets), transform=axes.transAxes, ha="right", va="top", fontsize=8.0, color=INK,
        path_effects=OUTLINE,
    )  # fmt: skip


def _height(row: Row) -> float:
    return min(max(row.errors.beyond, FLOOR), CEILING)
