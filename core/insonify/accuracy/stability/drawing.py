"""How the pictures of cases look: sober axes, one colour for what fails and one for what holds."""

from __future__ import annotations

from textwrap import wrap
from typing import Any

from matplotlib.figure import Figure

INK, FAINT = "#22262b", "#6b737c"
WRONG, RIGHT = "#b5651d", "#1f8a5b"


def add_panel(figure: Figure, place: int = 111, *, x: str, y: str, title: str = "") -> Any:
    """Put labelled axes on a figure.

    Parameters
    ----------
    figure : Figure
    place : int
        As matplotlib's ``add_subplot`` takes it.
    x, y : str
        Labels with units.
    title : str

    Returns
    -------
    matplotlib.axes.Axes
    """
    axes = figure.add_subplot(place)
    axes.set_xlabel(x, fontsize=9, color=INK)
    axes.set_ylabel(y, fontsize=9, color=INK)
    if title:
        axes.set_title(title, fontsize=9.5, color=INK, loc="left")
    axes.tick_params(which="both", color=FAINT, labelcolor=INK, labelsize=8.5)
    axes.grid(True, color=FAINT, alpha=0.18, linewidth=0.7)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set(color=FAINT, linewidth=0.8, visible=side in ("left", "bottom"))
    return axes


def add_legend(axes: Any, place: str = "best") -> None:
    """Name the lines of some axes."""
    axes.legend(loc=place, frameon=False, fontsize=8.5, labelcolor=INK)


def write_table(figure: Figure, heads: tuple[str, str, str], rows: list[tuple[str, str, str]]) -> None:
    """Set what is asked, what the plain way makes of it and what the own way says side by side.

    Parameters
    ----------
    figure : Figure
    heads : (str, str, str)
        Above the three columns.
    rows : list of (str, str, str)
        Broken into lines where they are long.
    """
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
