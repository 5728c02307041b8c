"""Drawing of charts: colours and marks of methods, logarithmic axes, labels, and power laws through series."""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from matplotlib.transforms import Bbox

from insonify.display.style import BLUE, BROWN, FAINT, GREEN, INK, VIOLET, make_figure, style_axes

# Colour and mark of the family that a method's name begins with.
FAMILIES = {"march": (BROWN, "s"), "rays": (BLUE, "o"), "sweep": (GREEN, "D"), "embree": (VIOLET, "^")}
# Offsets of a label from its point, in points, best first.
PLACES = (
    (0, 9),
    (0, -10),
    (9, 6),
    (-9, 6),
    (9, -7),
    (-9, -7),
    (0, 19),
    (0, -20),
    (18, 0),
    (-18, 0),
    (20, 14),
    (-20, 14),
)
OUTLINE = [withStroke(linewidth=2.2, foreground="white")]
WIDE, HIGH = 3.9, 3.2  # inches of a panel
ABOVE, BELOW, LEFT = 1.15, 0.95, 0.85
PANEL_ROOM = 0.75  # inches between panels
Row = TypeVar("Row")
Key = TypeVar("Key")


def style_of(method: str) -> tuple[str, str]:
    """Colour and mark of a method."""
    return FAMILIES.get(method.partition(",")[0], (INK, "o"))


def scale_axes(axes: Axes, *, x: Any, y: Any) -> None:
    """Make both axes logarithmic over a faint grid, with functions that format their numbers."""
    axes.set(xscale="log", yscale="log")
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: x(value)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: y(value)))
    axes.grid(True, which="major", color=FAINT, alpha=0.25, linewidth=0.8)
    axes.grid(True, which="minor", color=FAINT, alpha=0.10, linewidth=0.6)
    axes.set_axisbelow(True)
    style_axes(axes, 9.5)


def write_headings(figure: Figure, title: str, line: str, foot: str) -> None:
    """Write title and subtitle above a chart and the machine of the measurement below it."""
    width, height = figure.get_size_inches()
    left = 0.85 / width
    figure.text(left, 1.0 - 0.38 / height, title, fontsize=16, fontweight="bold", color=INK, va="center")
    figure.text(left, 1.0 - 0.70 / height, line, fontsize=10.5, color=FAINT, va="center")
    figure.text(left, 0.22 / height, foot, fontsize=8.5, color=FAINT, va="center")


def place_labels(axes: Axes, labels: Sequence[tuple[str, float, float, str]]) -> None:
    """Write labels beside their points, where they least overlap one another and all points."""
    figure = axes.figure.get_figure(root=True)
    assert figure is not None
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    points = [axes.transData.transform((x, y)) for _, x, y, _ in labels]
    half = 4.5 * figure.dpi / 72.0
    taken = [Bbox.from_extents(x - half, y - half, x + half, y + half) for x, y in points]
    frame = axes.get_window_extent(renderer)
    for number, (text, x, y, colour) in enumerate(labels):
        others = taken[:number] + taken[number + 1 :]
        best: tuple[float, Annotation, Bbox] | None = None
        for place in PLACES:
            note = axes.annotate(
                text, (x, y), xytext=place, textcoords="offset points", fontsize=8.0, color=colour, zorder=4,
                ha="center" if abs(place[0]) < 9 else ("left" if place[0] > 0 else "right"), va="center",
                path_effects=OUTLINE,
            )  # fmt: skip
            box = note.get_window_extent(renderer)
            cost = sum(_overlap(box, other) for other in others) + 4.0 * (box.width * box.height - _overlap(box, frame))
            if best is None or cost < best[0]:
                if best is not None:
                    best[1].remove()
                best = (cost, note, box)
            else:
                note.remove()
            if cost == 0.0:
                break
        assert best is not None
        taken.append(best[2])


def _overlap(one: Bbox, other: Bbox) -> float:
    wide = min(one.x1, other.x1) - max(one.x0, other.x0)
    high = min(one.y1, other.y1) - max(one.y0, other.y0)
    return float(max(wide, 0.0) * max(high, 0.0))


def format_time(microseconds: float) -> str:
    """Format a time in s, ms or µs."""
    for unit, size in (("s", 1e6), ("ms", 1e3)):
        if microseconds >= 0.999 * size:
            return f"{microseconds / size:.3g} {unit}"
    return f"{microseconds:.3g} µs"


def format_percent(share: float) -> str:
    """Format a share in percent with two digits."""
    return f"{np.format_float_positional(100.0 * share, 2, fractional=False, trim='-')} %"


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
    from scipy.stats import linregress  # lazy: slow to import

    fit = linregress(*np.log(points).T)
    return PowerLawFit(float(fit.slope), float(fit.stderr) if len(points) > 2 else math.nan, math.exp(fit.intercept))


def group_by(rows: Iterable[Row], key: Callable[[Row], Key]) -> dict[Key, list[Row]]:
    """Group rows by a key, in their order."""
    groups: dict[Key, list[Row]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return groups


def lay_out_panels(count: int, across: int) -> tuple[Figure, list[Axes]]:
    """Figure with a number of panels, and how many of them stand in a row."""
    rows = math.ceil(count / across)
    width, height = LEFT + across * WIDE - PANEL_ROOM + 0.3, ABOVE + rows * (HIGH + PANEL_ROOM) - PANEL_ROOM + BELOW
    figure = make_figure(width, height)
    panels = []
    for k in range(count):
        row, column = divmod(k, across)
        left, bottom = LEFT + column * WIDE, height - ABOVE - row * (HIGH + PANEL_ROOM) - HIGH
        panels.append(figure.add_axes((left / width, bottom / height, (WIDE - PANEL_ROOM) / width, HIGH / height)))
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
    colour, mark = style_of(method)
    law = f"{method} ∝ {symbol} to the {fit.format_exponent()}" if fit.format_exponent() else method
    axes.errorbar(
        x, y, yerr=bars, fmt=mark, color=colour, markersize=6.5, markeredgecolor="white", elinewidth=1.0,
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
