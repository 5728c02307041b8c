"""Pictures of stability cases: the common method in one colour, this program in another, exact values in ink."""

from collections.abc import Callable, Sequence
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from insonify.display.style import BROWN, FAINT, GREEN, INK, label_axes, style_axes

Picture = Callable[[Figure], Any]  # draws on an empty figure
FEW = 40  # points up to which each is marked
# Of the common method, of this program and of exact values: name, colour, width, style of a line, style of points.
STYLES = (
    ("common method", BROWN, 1.4, "-", "s"),
    ("this program", GREEN, 2.0, "-", "o"),
    ("exact", INK, 0.9, "--", "."),
)


def plot(
    x: str, y: str, at: Any, *curves: Any, log: str = "", down: bool = False, style: str = "", **limits: Any
) -> Picture:  # fmt: skip
    """Draw values of the common method, of this program and exact ones over an axis; a pair is places and values.

    Axes that are logarithmic are named, `down` points the y axis downwards, and `style` is the style of dots.
    """

    def draw(figure: Figure) -> None:
        axes: Any = figure.add_subplot()
        label_axes(axes, x, y, size=9)
        style_axes(axes, 8.5)
        axes.grid(True, color=FAINT, alpha=0.18, linewidth=0.7)
        axes.set(**{f"{axis}scale": "log" for axis in log})
        for values, (label, colour, width, line, marker) in zip(curves, STYLES):
            if values is None:
                continue
            places, shown = values if isinstance(values, tuple) else (at, values)
            shown = np.broadcast_to(shown, np.shape(places)) if np.ndim(shown) == 0 else np.asarray(shown)
            drawn = style or (f"{marker}{line}" if len(shown) <= FEW else line)
            above = 3.0 - 0.1 * len(axes.lines) if style else 2.0  # dots: the common method's on top
            lines = axes.plot(places, shown, drawn, color=colour, linewidth=width, markersize=3, zorder=above)
            lines[0].set_label(label)
        axes.set(**limits)
        if down:
            axes.invert_yaxis()
        axes.legend(frameon=False, fontsize=8.5, labelcolor=INK)

    return draw


def table(rows: Sequence[tuple[str, str, str]]) -> Picture:
    """Draw a table of three columns: the input, the result of the common method, the result of this program."""

    def draw(figure: Figure) -> None:
        axes = figure.add_subplot()
        axes.axis("off")
        places, widths = (0.0, 0.27, 0.5), (28, 24, 54)
        heads = [(["input"], ["common method"], ["this program"])]
        lines = [*heads, *([wrap(text, width) or [""] for text, width in zip(row, widths)] for row in rows)]
        heights = [max(map(len, row)) + 0.6 for row in lines]
        for row, below in zip(lines, np.cumsum([0.0, *heights]) / (sum(heights) + 0.2)):
            for x, text, colour in zip(places, row, (INK, BROWN, GREEN)):
                axes.text(x, 1.0 - below, "\n".join(text), color=colour, fontsize=7.8, va="top", linespacing=1.15)

    return draw
