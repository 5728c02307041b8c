"""How the pictures of cases look: sober axes, one colour for what fails and one for what holds."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

INK, FAINT = "#22262b", "#6b737c"
WRONG, RIGHT = "#b5651d", "#1f8a5b"


def panel(figure: Figure, place: int = 111, *, x: str, y: str, title: str = "") -> Any:
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


def named(axes: Any, place: str = "best") -> None:
    """Name the lines of some axes."""
    axes.legend(loc=place, frameon=False, fontsize=8.5, labelcolor=INK)
