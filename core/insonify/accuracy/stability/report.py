"""Stability page: a table of all cases, then every case with its picture, in one HTML file."""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping, Sequence
from html import escape
from importlib.metadata import version
from io import BytesIO
from pathlib import Path

from matplotlib.figure import Figure

from insonify.accuracy.stability.case import Approach, Outcome, StabilityCase, format_quantity
from insonify.io.atomic import replacing

WIDTH, HEIGHT, DPI = 7.2, 2.9, 130
INTRODUCTION = (
    "Every method of simulating sound fails somewhere: in a layer without a gradient, straight above a knot, in a "
    "number of too few digits. Each case below triggers one such failure and measures two methods against the truth: a "
    "common one, which fails, and the one that this program uses. A method that gives no number also fails."
)
HEADS = (("", "Case"), (' class="trigger"', "Trigger"), ("", "Common method"), ("", "This program"), ("", "Verdict"))
STYLE = """
:root { --ink: #22262b; --faint: #6b737c; --line: #dde1e5; --wrong: #a4571a; --right: #17754c; }
* { box-sizing: border-box; }
body { margin: 0; background: #f4f5f6; color: var(--ink); font: 16px/1.55 system-ui, "Segoe UI", Roboto, sans-serif; }
main { max-width: 62rem; margin: 0 auto; padding: 3rem 2.5rem 4rem; background: white; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .6rem; letter-spacing: -.01em; }
h2 { font-size: 1.25rem; margin: 3rem 0 .2rem; padding-bottom: .3rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1.05rem; margin: 1.8rem 0 .2rem; }
p { margin: .3rem 0 .6rem; max-width: 46rem; }
a { color: inherit; text-decoration-color: var(--line); text-underline-offset: .2em; }
.faint { color: var(--faint); }
.wrong { color: var(--wrong); }
.right { color: var(--right); }
.bad { color: #b00020; font-weight: 600; }
table { width: 100%; border-collapse: collapse; margin-top: 1.5rem; font-size: .87rem; line-height: 1.35; }
th, td { text-align: left; vertical-align: top; padding: .42rem .6rem; border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--faint); border-bottom-color: var(--ink); }
td:first-child, th:first-child { padding-left: 0; }
td:first-child { min-width: 11rem; }
tr.theme td { padding-top: 1.1rem; font-weight: 600; }
code, .figure { white-space: nowrap; }
.figure { font-variant-numeric: tabular-nums; }
dl { display: grid; grid-template-columns: 3.5rem 8.5rem 1fr; gap: .15rem 1rem; margin: .5rem 0 .8rem; }
dl { font-size: .93rem; max-width: 56rem; }
dt { font-weight: 600; }
dd { margin: 0; }
img { display: block; width: 100%; max-width: 46rem; height: auto; margin: .6rem 0 1rem; }
@media (max-width: 45rem) {
  main { padding: 1.5rem 1rem; }
  .trigger { display: none; }
  dl { grid-template-columns: 3.5rem 1fr; }
  dd.does { grid-column: 1 / -1; }
}
@media print {
  body { background: none; }
  main { max-width: none; padding: 0; }
  section { break-inside: avoid; }
}
"""


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
    text = _lay_out_page(outcomes)
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")
    return [outcome for members in outcomes.values() for outcome in members]


def _lay_out_page(outcomes: Mapping[str, list[Outcome]]) -> str:
    """Lay outcomes out as HTML."""
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
    heads = "".join(f"<th{kind}>{head}</th>" for kind, head in HEADS)
    summary = f"{held} of {number} cases: the common method exceeds its bound, and this program keeps its own."
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>Where methods fail</title><style>{STYLE}</style></head>\n<body><main>\n"
        f"<h1>Where methods fail</h1>\n<p>{escape(INTRODUCTION)}</p>\n<p>{escape(summary)}</p>\n"
        f"<table><thead><tr>{heads}</tr></thead>\n<tbody>\n{''.join(rows)}</tbody></table>\n{''.join(sections)}"
        f'<p class="faint">insonify {escape(version("insonify"))}</p>\n</main></body></html>\n'
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
