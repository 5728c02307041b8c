"""Series of points with the power laws fitted to them, and panels that draw both."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from insonify.accuracy.charts.style import get_colour, get_mark
from insonify.display.style import INK, make_figure

WIDE, HIGH = 3.9, 3.2  # inches of a panel
ABOVE, BELOW, LEFT = 1.15, 0.95, 0.85
ROOM = 0.75  # inches between panels
Row = TypeVar("Row")
Key = TypeVar("Key")


class PowerLawFit(NamedTuple):
    """Power law y = scale · x^exponent fitted to points."""

    exponent: float  # slope of the straight line through the logarithms; NaN with fewer than two points
    spread: float  # standard error of the exponent; NaN with fewer than three points
    scale: float  # value of y at x = 1

    def format_exponent(self) -> str:
        """Format the exponent with its standard error; empty where there is none."""
        if math.isnan(self.exponent):
            return ""
        exponent = f"{self.exponent:.2f}".replace("-", "−")
        return exponent + (f" ± {self.spread:.2f}" if math.isfinite(self.spread) else "")


def fit_power_law(x: Sequence[float], y: Sequence[float]) -> PowerLawFit:
    """Fit a power law by least squares in the logarithms."""
    points = np.array([(a, b) for a, b in zip(x, y) if 0.0 < a < math.inf and 0.0 < b < math.inf]).reshape(-1, 2)
    if len(np.unique(points[:, 0])) < 2:
        return PowerLawFit(math.nan, math.nan, math.nan)
    along, up = np.log(points).T
    off, high = along - along.mean(), up - up.mean()
    width = float(off @ off)
    exponent = float(off @ high) / width
    left = high - exponent * off
    spread = math.sqrt(float(left @ left) / (len(points) - 2) / width) if len(points) > 2 else math.nan
    return PowerLawFit(exponent, spread, math.exp(float(up.mean() - exponent * along.mean())))


def group_by(rows: Iterable[Row], key: Callable[[Row], Key]) -> dict[Key, list[Row]]:
    """Group rows by a key, in their order."""
    groups: dict[Key, list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def lay_out_panels(count: int, across: int) -> tuple[Figure, list[Axes]]:
    """Figure with a number of panels, so many in a row."""
    rows = math.ceil(count / across)
    width, height = LEFT + across * WIDE - ROOM + 0.3, ABOVE + rows * (HIGH + ROOM) - ROOM + BELOW
    figure = make_figure(width, height)
    panels = []
    for k in range(count):
        row, column = divmod(k, across)
        left, bottom = LEFT + column * WIDE, height - ABOVE - row * (HIGH + ROOM) - HIGH
        panels.append(figure.add_axes((left / width, bottom / height, (WIDE - ROOM) / width, HIGH / height)))
    return figure, panels


def draw_series(
    axes: Axes,
    method: str,
    x: Sequence[float],
    y: Sequence[float],
    fit: PowerLawFit,
    symbol: str,
    bars: Sequence[float] | None = None,
) -> None:
    """Draw the points of a method and the power law through them."""
    colour = get_colour(method)
    law = f"{method} ∝ {symbol} to the {fit.format_exponent()}" if fit.format_exponent() else method
    axes.errorbar(
        x, y, yerr=bars, fmt=get_mark(method), color=colour, markersize=6.5, markeredgecolor="white", elinewidth=1.0,
        zorder=3, label=law,
    )  # fmt: skip
    if fit.format_exponent() and x:
        ends = np.array([min(x), max(x)])
        axes.plot(ends, fit.scale * ends**fit.exponent, color=colour, linewidth=1.2, alpha=0.6, zorder=2)


def finish_panel(axes: Axes) -> None:
    """Make room for the legend, and set ticks at 1, 2 and 5 where an axis spans few decades."""
    axes.margins(0.1)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.18)
    short = high < 30.0 * low
    for axis, every in ((axes.xaxis, True), (axes.yaxis, short)):
        axis.set_major_locator(LogLocator(base=10.0, subs=(1.0, 2.0, 5.0) if every else (1.0,), numticks=20))
        axis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=8.5)
    axes.legend(loc="upper left", frameon=False, fontsize=8.5, labelcolor=INK, handletextpad=0.4)


def format_count(value: float) -> str:
    """Format a count, of ten thousand or more in thousands."""
    return f"{value:g}" if value < 10_000 else f"{value / 1000:g}k"
