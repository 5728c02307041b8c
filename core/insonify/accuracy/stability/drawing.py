"""Drawing of stability cases: one colour for the common method, one for this program."""

from collections.abc import Callable, Sequence
from functools import partial
from textwrap import wrap
from typing import Any

from matplotlib.figure import Figure

from insonify.display.style import BROWN, FAINT, GREEN, INK, label_axes, style_axes

WRONG, RIGHT = BROWN, GREEN
Picture = Callable[[Figure], Any]  # draws on an empty figure
Curve = Callable[[Any], None]  # draws on the axes of a panel


def curve(colour: str, x: Any, y: Any, label: str = "", style: str = "-", **options: Any) -> Curve:
    """Line or points with options of Matplotlib; without ``x`` or ``y`` a straight line across the whole panel."""
    options = {"color": colour, **({"label": label} if label else {}), **options}

    def draw(axes: Any) -> None:
        if x is None:
            axes.axhline(y, linestyle=style, **options)
        elif y is None:
            axes.axvline(x, linestyle=style, **options)
        else:
            axes.plot(x, y, style, **options)

    return draw


common = partial(curve, WRONG)  # of the common method
ours = partial(curve, RIGHT)  # of this program
inked = partial(curve, INK)  # exact values
faint = partial(curve, FAINT)


def panel(
    *curves: Curve, x: str, y: str, title: str = "", place: int = 111, log: str = "", legend: str = "best",
    down: bool = False, **limits: Any,
) -> Picture:  # fmt: skip
    """Picture of curves: axes that are logarithmic are named, `down` points the y axis downwards."""

    def draw(figure: Figure) -> Any:
        axes = figure.add_subplot(place)
        label_axes(axes, x, y, size=9)
        if title:
            axes.set_title(title, fontsize=9.5, color=INK, loc="left")
        style_axes(axes, 8.5)
        axes.grid(True, color=FAINT, alpha=0.18, linewidth=0.7)
        axes.set_axisbelow(True)
        axes.set(**{f"{axis}scale": "log" for axis in log})
        for each in curves:
            each(axes)
        axes.set(**limits)
        if down:
            axes.invert_yaxis()
        if legend and axes.get_legend_handles_labels()[0]:
            add_legend(axes, legend)
        return axes

    return draw


def side_by_side(*pictures: Picture) -> Picture:
    """Picture of several panels, each with a place of its own."""
    return lambda figure: [picture(figure) for picture in pictures]


def add_legend(axes: Any, place: str = "best", **options: Any) -> None:
    """Add a legend without a frame."""
    axes.legend(loc=place, frameon=False, fontsize=8.5, labelcolor=INK, **options)


def table(heads: tuple[str, str, str], rows: Sequence[tuple[str, str, str]]) -> Picture:
    """Table of three columns: the input, the result of the common method, the result of this program."""

    def draw(figure: Figure) -> None:
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

    return draw
