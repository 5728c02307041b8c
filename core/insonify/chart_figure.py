"""The chart as a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter

if TYPE_CHECKING:
    from insonify.chart import Chart

COLOURS = {"march": "#b5651d", "rays": "#2f6f9f", "sweep": "#1f8a5b"}
MARKS = {"march": "s", "rays": "o", "sweep": "D"}
# Offset of a label in points and its side: each method keeps to its own, so that names seldom meet.
LABELS = {"march": (0, 13, "center"), "rays": (6, 11, "left"), "sweep": (-7, -9, "right")}
INK, FAINT = "#22262b", "#6b737c"
FLOOR = 1e-6  # errors below it are drawn there


def draw(chart: Chart) -> Figure:
    """Draw error against time per ping, both on logarithmic axes, with the front of the best.

    Parameters
    ----------
    chart : Chart
        What was measured.

    Returns
    -------
    matplotlib.figure.Figure
        With an Agg canvas.
    """
    figure = Figure(figsize=(10.0, 7.0), facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.085, 0.135, 0.885, 0.735))
    axes.set(xscale="log", yscale="log")
    _scales(axes)
    front = chart.front()
    axes.plot(
        [row.microseconds for row in front],
        [_height(row.error_beyond) for row in front],
        color=INK, linewidth=7.0, alpha=0.10, solid_capstyle="round", solid_joinstyle="round", zorder=1,
        label="best for its time",
    )  # fmt: skip
    for method in COLOURS:
        _points(axes, chart, method)
    _floor(axes, chart)
    axes.margins(0.09)
    # Room for the names that stand to the right of the slowest.
    axes.set_xlim(right=1.4 * axes.get_xlim()[1])
    axes.legend(loc="upper right", frameon=False, fontsize=10, labelcolor=INK)
    _headings(figure, chart)
    return figure


def _points(axes: Any, chart: Chart, method: str) -> None:
    """One method: a line through its settings, a mark and a label for each."""
    rows = [row for row in chart.rows if row.method == method]
    x = [row.microseconds for row in rows]
    y = [_height(row.error_beyond) for row in rows]
    colour = COLOURS[method]
    axes.plot(x, y, color=colour, linewidth=1.2, alpha=0.6, zorder=2)
    axes.errorbar(
        x, y, xerr=[row.spread * row.microseconds for row in rows],
        fmt=MARKS[method], color=colour, markersize=7, markeredgecolor="white", elinewidth=1.0, zorder=3, label=method,
    )  # fmt: skip
    right, up, align = LABELS[method]
    for row, left, top in zip(rows, x, y):
        axes.annotate(
            row.setting, (left, top), xytext=(right, up), textcoords="offset points",
            ha=align, va="center", fontsize=8.5, color=colour, zorder=4,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )  # fmt: skip


def _floor(axes: Any, chart: Chart) -> None:
    """Mark the error below which the reference cannot tell."""
    low = _height(chart.moved)
    axes.axhspan(FLOOR, low, color=FAINT, alpha=0.08, linewidth=0, zorder=0)
    axes.text(
        0.01, low, f"finer than the reference ({_percent(low)})", transform=axes.get_yaxis_transform(),
        ha="left", va="top", fontsize=8.5, color=FAINT,
    )  # fmt: skip
    lowest = min([_height(row.error_beyond) for row in chart.rows] + [low])
    axes.set_ylim(bottom=0.6 * lowest)


def _scales(axes: Any) -> None:
    axes.set_xlabel("time per ping, both sides, one thread", fontsize=10.5, color=INK, labelpad=6)
    axes.set_ylabel("error beyond 1.4 × altitude", fontsize=10.5, color=INK, labelpad=6)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: _time(value)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: _percent(value)))
    axes.grid(True, which="major", color=FAINT, alpha=0.25, linewidth=0.8)
    axes.grid(True, which="minor", color=FAINT, alpha=0.10, linewidth=0.6)
    axes.tick_params(which="both", color=FAINT, labelcolor=INK, labelsize=9.5)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set(color=FAINT, linewidth=0.8, visible=side in ("left", "bottom"))


def _headings(figure: Figure, chart: Chart) -> None:
    figure.text(0.085, 0.945, "Speed against accuracy", fontsize=16, fontweight="bold", color=INK)
    pings = f"{chart.pings} ping{'s' * (chart.pings != 1)}"
    figure.text(0.085, 0.905, f"{chart.title or 'untitled scene'} · {pings}", fontsize=10.5, color=FAINT)
    figure.text(0.085, 0.03, chart.machine, fontsize=8.5, color=FAINT)


def _height(error: float) -> float:
    return max(error, FLOOR)


def _time(microseconds: float) -> str:
    for unit, size in (("s", 1e6), ("ms", 1e3)):
        if microseconds >= size:
            return f"{microseconds / size:g} {unit}"
    return f"{microseconds:g} µs"


def _percent(share: float) -> str:
    return f"{float(f'{100.0 * share:.2g}'):g} %"
