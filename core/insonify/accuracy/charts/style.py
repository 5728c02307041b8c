"""Style of charts: colours and marks of methods, logarithmic axes, and labels that keep clear of one another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation
from matplotlib.ticker import FuncFormatter
from matplotlib.transforms import Bbox

from insonify.display.style import BLUE, BROWN, FAINT, GREEN, INK, VIOLET, style_axes

COLOURS = {"march": BROWN, "rays": BLUE, "sweep": GREEN, "embree": VIOLET}
MARKS = {"march": "s", "rays": "o", "sweep": "D", "embree": "^"}
SHADES = {
    "sweep, every 2nd node": "#7fa83a",
    "sweep, every 4th node": "#c4a32a",
    "sweep, whole segments": "#b5473c",
    "sweep, segments to 3 %": "#d9822b",
    "sweep, segments to 1 %": "#2a8fa3",
    "sweep, straight": "#8b9299",
    "rays, straight": "#8b9299",
    "sweep, float64": "#0f4f35",
    "embree, against its own triangles": "#c58bc9",
}
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


def get_colour(method: str) -> str:
    """Colour of a method, or of the family that its name begins with."""
    return SHADES.get(method) or COLOURS.get(_family(method), INK)


def get_mark(method: str) -> str:
    """Mark of the family that a method's name begins with."""
    return MARKS.get(_family(method), "o")


def _family(method: str) -> str:
    return method.partition(",")[0]


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
    """Write labels beside their points, with the least overlap with one another and with all points."""
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
            cost = sum(_overlap(box, other) for other in others) + 4.0 * (_area(box) - _overlap(box, frame))
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


def _area(box: Bbox) -> float:
    return float(box.width * box.height)


def format_time(microseconds: float) -> str:
    """Format a time in s, ms or µs."""
    for unit, size in (("s", 1e6), ("ms", 1e3)):
        if microseconds >= 0.999 * size:
            return f"{microseconds / size:.3g} {unit}"
    return f"{microseconds:.3g} µs"


def format_percent(share: float) -> str:
    """Format a share in percent with two digits."""
    return f"{np.format_float_positional(100.0 * share, 2, fractional=False, trim='-')} %"
