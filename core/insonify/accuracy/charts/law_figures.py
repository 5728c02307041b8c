"""The charts of cost and of convergence as pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from insonify.accuracy.charts.fit import Fit
from insonify.accuracy.charts.style import (
    FAINT,
    INK,
    as_percent,
    as_time,
    colour_of,
    mark_of,
    scale_axes,
    write_headings,
)

if TYPE_CHECKING:
    from insonify.accuracy.charts.convergence import ConvergenceChart
    from insonify.accuracy.charts.cost import CostChart

WIDE, HIGH = 3.9, 3.2  # inches of a panel
ABOVE, BELOW, LEFT = 1.15, 0.95, 0.85
ROOM = 0.75  # of an inch between panels
AGAINST = {
    "march, step in m": "error against as many exact rays",
    "sweep, spacing in m": "error against all nodes of the bed",
}


def draw_cost(chart: CostChart) -> Figure:
    """Draw time against size, a panel for each thing that grows, with the fitted laws.

    Parameters
    ----------
    chart : CostChart
        What was measured.

    Returns
    -------
    matplotlib.figure.Figure
        With an Agg canvas.
    """
    axes_of = list(dict.fromkeys(row.axis for row in chart.rows))
    figure, panels = _panels(len(axes_of), 3)
    write_headings(figure, "Cost against size", chart.title or "untitled scene", chart.machine)
    fits = chart.fits()
    for axes, axis in zip(panels, axes_of):
        scale_axes(axes, x=_count, y=as_time)
        axes.set_xlabel(axis, fontsize=10, color=INK)
        axes.set_title(
            "time of all pings" if axis == "pings" else "time per ping", fontsize=9.5, color=FAINT, loc="left"
        )
        for method in dict.fromkeys(row.method for row in chart.rows if row.axis == axis):
            rows = [row for row in chart.rows if (row.axis, row.method) == (axis, method)]
            x, y = [row.size for row in rows], [row.microseconds for row in rows]
            _series(axes, method, x, y, fits[axis, method], "size", [row.spread * row.microseconds for row in rows])
        _finish(axes)
    return figure


def draw_convergence(chart: ConvergenceChart) -> Figure:
    """Draw error against step or count, a panel for each method, with the fitted orders.

    Parameters
    ----------
    chart : ConvergenceChart
        What was measured.

    Returns
    -------
    matplotlib.figure.Figure
        With an Agg canvas.
    """
    series = list(dict.fromkeys(point.series for point in chart.points))
    figure, panels = _panels(len(series), 2)
    told = f"{chart.title or 'untitled scene'} · hollow: not resolved by the reference, not fitted"
    write_headings(figure, "Convergence", told, chart.machine)
    fits = chart.fits()
    for axes, name in zip(panels, series):
        points = [point for point in chart.points if point.series == name and point.error > 0.0]
        scale_axes(axes, x=_count, y=as_percent)
        method, _, what = name.partition(", ")
        axes.set_xlabel(what or "rays a side", fontsize=10, color=INK)
        axes.set_title(AGAINST.get(name, "error against the reference"), fontsize=9.5, color=FAINT, loc="left")
        known, unknown = ([point for point in points if point.resolved is told] for told in (True, False))
        x, y = [point.size for point in known], [point.error for point in known]
        _series(
            axes, method, x, y, fits[name], "step" if "step" in name else "spacing" if "spacing" in name else "count"
        )
        axes.plot(
            [point.size for point in unknown], [point.error for point in unknown], linestyle="none",
            marker=mark_of(method), markersize=6.5, markerfacecolor="white", markeredgecolor=colour_of(method),
        )  # fmt: skip
        if " in m" in name:
            axes.invert_xaxis()
        else:
            axes.axhspan(1e-9, chart.reference.floor, color=FAINT, alpha=0.10, linewidth=0, zorder=0)
        axes.set_ylim(0.5 * min(point.error for point in points), 2.5 * max(point.error for point in points))
        _finish(axes)
    return figure


def _panels(count: int, across: int) -> tuple[Figure, list[Axes]]:
    """Lay panels out in rows."""
    rows = math.ceil(count / across)
    width, height = LEFT + across * WIDE - ROOM + 0.3, ABOVE + rows * (HIGH + ROOM) - ROOM + BELOW
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    panels = []
    for k in range(count):
        row, column = divmod(k, across)
        left, bottom = LEFT + column * WIDE, height - ABOVE - row * (HIGH + ROOM) - HIGH
        panels.append(figure.add_axes((left / width, bottom / height, (WIDE - ROOM) / width, HIGH / height)))
    return figure, panels


def _series(
    axes: Axes,
    method: str,
    x: Sequence[float],
    y: Sequence[float],
    fit: Fit,
    symbol: str,
    bars: Sequence[float] | None = None,
) -> None:
    """One method: its points and the law through them."""
    colour = colour_of(method)
    law = f"{method} ∝ {symbol} to the {fit.words()}" if fit.words() else method
    axes.errorbar(
        x, y, yerr=bars, fmt=mark_of(method), color=colour, markersize=6.5, markeredgecolor="white", elinewidth=1.0,
        zorder=3, label=law,
    )  # fmt: skip
    if fit.words() and x:
        ends = np.array([min(x), max(x)])
        axes.plot(ends, fit.scale * ends**fit.exponent, color=colour, linewidth=1.2, alpha=0.6, zorder=2)


def _finish(axes: Axes) -> None:
    axes.margins(0.1)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.18)
    short = high < 30.0 * low
    for axis, every in ((axes.xaxis, True), (axes.yaxis, short)):
        axis.set_major_locator(LogLocator(base=10.0, subs=(1.0, 2.0, 5.0) if every else (1.0,), numticks=20))
        axis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=8.5)
    axes.legend(loc="upper left", frameon=False, fontsize=8.5, labelcolor=INK, handletextpad=0.4)


def _count(value: float) -> str:
    return f"{value:g}" if value < 10_000 else f"{value / 1000:g}k"
