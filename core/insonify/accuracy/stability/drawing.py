"""Drawing of stability cases: one colour for the method that fails and one for the method that holds."""

from __future__ import annotations

from textwrap import wrap
from typing import Any

from matplotlib.figure import Figure

from insonify.display.style import BROWN, FAINT, GREEN, INK, label_axes, style_axes

WRONG, RIGHT = BROWN, GREEN


def add_panel(figure: Figure, place: int = 111, *, x: str, y: str, title: str = "") -> Any:
    """Add labelled axes to a figure."""
    axes = figure.add_subplot(place)
    label_axes(axes, x, y, size=9)
    if title:
        axes.set_title(title, fontsize=9.5, color=INK, loc="left")
    style_axes(axes, 8.5)
    axes.grid(True, color=FAINT, alpha=0.18, linewidth=0.7)
    axes.set_axisbelow(True)
    return axes


def add_legend(axes: Any, place: str = "best", **options: Any) -> None:
    """Add a legend without a frame."""
    axes.legend(loc=place, frameon=False, fontsize=8.5, labelcolor=INK, **options)


def write_table(figure: Figure, heads: tuple[str, str, str], rows: list[tuple[str, str, str]]) -> None:
    """Write a table of three columns: the input, what the common method does, what this program does."""
    axes = figure.add_subplot()
    axes.axis("off")
    places, widths = (0.0, 0.27, 0.5), (28, 24, 54)
    lines = [[wrap(text, width) or [""] for text, width in zip(row, widths)] for row in rows]
    heights = [max(map(len, row)) + 0.6 for row in lines]
    top, per_line = 1.0, 1.0 / (sum(heights) + 1.8)
    for x, head, colour in zip(places, heads, (INK, WRONG, RIGHT)):
        axes.text(x, top, head, color=colour, fontsize=8.5, fontweight="bold", va="top")
    top -= 1.5 * per_line
    for row, height in zip(lines, heights):
        for x, text, colour in zip(places, row, (INK, WRONG, RIGHT)):
            axes.text(x, top, "\n".join(text), color=colour, fontsize=7.8, va="top", linespacing=1.15)
        top -= height * per_line
