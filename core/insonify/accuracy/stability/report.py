"""Stability page: a table of all cases, then every case with its picture, in one HTML file."""

from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from io import BytesIO
from pathlib import Path

from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Outcome, StabilityCase
from insonify.io.atomic import write_text
from insonify.io.pages import fill_page, picture_url

WIDTH, HEIGHT, DPI = 7.2, 2.9, 130


def write_report(
    path: str | Path,
    cases: Mapping[str, Sequence[StabilityCase]],
    *,
    done: Callable[[StabilityCase], None] = lambda case: None,
) -> list[Outcome]:
    """Measure cases and write them as a page."""
    outcomes: dict[str, list[Outcome]] = {}
    for theme, members in cases.items():
        outcomes[theme] = []
        for case in members:
            outcomes[theme].append(Outcome(case, case.measure()))
            done(case)
    write_text(path, fill_page("stability", themes=outcomes, draw=_draw, version=version("insonify")))
    return [outcome for members in outcomes.values() for outcome in members]


def _draw(outcome: Outcome) -> str:
    """Address of the picture of a case, which contains it."""
    figure = Figure(figsize=(WIDTH, HEIGHT), facecolor="white", layout="constrained")
    outcome.measured.picture(figure)
    memory = BytesIO()
    figure.savefig(memory, format="png", dpi=DPI)
    return picture_url(memory.getvalue())
