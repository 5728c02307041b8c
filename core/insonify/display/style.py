"""One style of all figures: colours, figures, axes and their labels."""

from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK, FAINT = "#22262b", "#6b737c"  # text and data; frames, ticks, grids and remarks
BROWN, BLUE, GREEN, VIOLET = "#b5651d", "#2f6f9f", "#1f8a5b", "#8a3f8f"  # series of data
ORANGE, RED, AMBER, PINK, PURPLE = "#c2571a", "#d1495b", "#e08e1b", "#c2185b", "#7a3fa0"
LINE_WIDTH = 0.8  # points, of frames and ticks


def make_figure(width: float, height: float, **options: Any) -> Figure:
    """Empty white figure of a size in inches, with an Agg canvas."""
    figure = Figure(figsize=(width, height), facecolor="white", **options)
    FigureCanvasAgg(figure)
    return figure


def style_axes(axes: Any, size: float, *, framed: bool = False, width: float = LINE_WIDTH) -> None:
    """Set ticks and frame of some axes: a whole frame, or its left and lower sides."""
    axes.tick_params(which="both", color=FAINT, labelcolor=INK, labelsize=size, width=width)
    for side, spine in axes.spines.items():
        spine.set(color=FAINT, linewidth=width, visible=framed or side in ("left", "bottom"))


def label_axes(axes: Any, x: str = "", y: str = "", *, size: float = 10.0, pad: float = 4.0) -> None:
    """Label the axes that a text is given for."""
    for write, text in ((axes.set_xlabel, x), (axes.set_ylabel, y)):
        if text:
            write(text, fontsize=size, color=INK, labelpad=pad)
