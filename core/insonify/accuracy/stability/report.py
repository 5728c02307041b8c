"""Stability page: a table of all cases, then every case with its picture, in one HTML file."""

import base64
from collections.abc import Callable, Mapping, Sequence
from html import escape
from importlib.metadata import version
from io import BytesIO
from pathlib import Path
from string import Template

from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, Outcome, StabilityCase, format_quantity
from insonify.files import resources
from insonify.io.atomic import write_text

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
    write_text(path, _lay_out_page(outcomes))
    return [outcome for members in outcomes.values() for outcome in members]


def _lay_out_page(outcomes: Mapping[str, list[Outcome]]) -> str:
    """Fill the page in ``resources/pages`` with outcomes."""
    rows, sections = [], []
    number = held = 0
    for theme, members in outcomes.items():
        rows.append(f'<tr class="theme"><td colspan="5">{escape(theme)}</td></tr>')
        sections.append(f"<h2>{escape(theme)}</h2>")
        for outcome in members:
            number += 1
            held += outcome.is_held and outcome.is_shown
            rows.append(_row(outcome, number))
            sections.append(_section(outcome, number))
    page = Template((resources() / "pages" / "stability.html").read_text(encoding="utf-8"))
    return page.substitute(
        summary=f"{held} of {number} cases: the common method exceeds its bound, and this program keeps its own.",
        rows="".join(rows),
        sections="".join(sections),
        version=escape(version("insonify")),
    )


def _row(outcome: Outcome, number: int) -> str:
    """Row of the table of all cases."""
    case, measured = outcome.case, outcome.measured
    kind = "right" if outcome.is_held and outcome.is_shown else "bad"
    return (
        f'<tr><td><a href="#case-{number}">{escape(case.name)}</a></td>'
        f'<td class="trigger faint">{escape(case.trigger)}</td>'
        f'<td class="figure wrong">{escape(format_quantity(measured.failing, case.unit))}</td>'
        f'<td class="figure right">{escape(format_quantity(measured.right, case.unit))}</td>'
        f'<td class="{kind}">{outcome.verdict}</td></tr>\n'
    )


def _section(outcome: Outcome, number: int) -> str:
    """Section of one case: cause, both methods, picture."""
    case, measured = outcome.case, outcome.measured
    scene = f", on the scene <code>{escape(case.scene)}</code>" if case.scene else ""
    methods = (
        _method("wrong", "Common", measured.failing, case.failing, case.unit),
        _method("right", "Own", measured.right, case.right, case.unit),
    )
    return (
        f'<section id="case-{number}"><h3>{escape(case.name)}</h3>\n<p>{escape(case.trigger)} '
        f'<span class="faint">Measured: {escape(case.figure)}{scene}.</span></p>\n'
        f"<dl>{''.join(methods)}</dl>\n{_picture(outcome)}</section>\n"
    )


def _method(kind: str, name: str, value: float, approach: Approach, unit: str) -> str:
    """One method of a case, with its error and bound."""
    bound = f"({'bound' if kind == 'right' else 'fails above'} {format_quantity(approach.bound, unit)})"
    return (
        f'<dt class="{kind}">{name}</dt><dd class="figure {kind}">{escape(format_quantity(value, unit))}</dd>'
        f'<dd class="does">{escape(approach.does)} <span class="faint">{escape(bound)}</span></dd>'
    )


def _picture(outcome: Outcome) -> str:
    """Picture of a case as an inlined PNG."""
    figure = Figure(figsize=(WIDTH, HEIGHT), facecolor="white", layout="constrained")
    outcome.measured.picture(figure)
    memory = BytesIO()
    figure.savefig(memory, format="png", dpi=DPI)
    data = base64.b64encode(memory.getvalue()).decode("ascii")
    alt = f"{escape(outcome.case.name)}: {escape(outcome.case.figure)}"
    return f'<img src="data:image/png;base64,{data}" alt="{alt}">\n'
