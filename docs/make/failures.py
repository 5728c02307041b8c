"""The page of failures with their measured errors, the rows of it that the first page shows, and two pictures."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

HEAD = """# Where methods fail

<!-- Made by `python docs/make stability` from the cases in `insonify.accuracy.stability`. Edit those. -->

Methods that simulate sound fail in known places: in a layer without a gradient, straight above a knot, with too few
digits. Each row sets up one such place and measures two methods against the truth: the plain one and the one used here.
`insonify stability -o report.html` measures and draws all of them on your machine, and every row is also a test. There
are {count} rows; the method used here keeps its bound in {held}.

"""
ROWS = "| failure | measured | plain method | here |\n|---|---|---|---|\n"
PICTURES = """The level about a caustic, and a bed of crests that is sampled in steps of two metres:

![Level near a caustic: the sum of two rays has no bound, the method used here follows the exact wave](
{folder}pictures/failure-caustic.svg)

![Long steps pass a crest and put energy into the shadows, segments keep the shadows dark](
{folder}pictures/failure-steps.svg)
""".replace("](\n", "](")
DRAWN = {"failure-caustic": "A caustic", "failure-steps": "Steps too long"}
SHOWN = (
    "A caustic",
    "A shadow zone",
    "Steps too long",
    "Too few planes across a fan",
    "A lobe narrower than a cell's twist",
    "Range factors inside a float32 sum",
)
BETWEEN = re.compile(r"(<!-- rows of stability -->\n).*?(<!-- end -->)", re.DOTALL)


def write(docs: Path) -> None:
    """Measure all cases; write the page, the rows of the first page, and the pictures."""
    from insonify.accuracy.stability import CASES
    from insonify.accuracy.stability.case import Outcome

    themes = {theme: [Outcome(case, case.measure()) for case in cases] for theme, cases in CASES.items()}
    named = {each.case.name: each for outcomes in themes.values() for each in outcomes}
    held = sum(each.holds for each in named.values())
    text = [HEAD.format(count=len(named), held="all" if held == len(named) else held), PICTURES.format(folder="../")]
    for theme, outcomes in themes.items():
        text += [f"\n## {theme}\n\n{ROWS}", *(_row(each, why=True) for each in outcomes)]
    (docs / "accuracy" / "stability.md").write_text("".join(text), encoding="utf-8")
    first = docs / "index.md"
    rows = ROWS + "".join(_row(named[name], why=False) for name in SHOWN) + "\n" + PICTURES.format(folder="")
    first.write_text(BETWEEN.sub(rf"\g<1>{rows}\g<2>", first.read_text(encoding="utf-8")), encoding="utf-8")
    for name, case in DRAWN.items():
        _draw(named[case], docs / "pictures" / f"{name}.svg")


def _row(outcome: Any, *, why: bool) -> str:
    """Return one row of the table, with the cause of the failure if it is wanted."""
    case, (failing, right, _) = outcome.case, outcome.measured
    cause = f"**{case.name}.** {case.trigger}" if why else case.name
    plain, ours = (case.format(each) for each in (failing, right))
    if why:
        plain, ours = f"{plain}. {case.failing}", f"{ours}. {case.right}"
    return f"| {cause} | {case.quantity} | {plain} | {ours} |\n"


def _draw(outcome: Any, path: Path) -> None:
    """Draw the picture of a case."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 3.2), facecolor="white", layout="constrained")
    outcome.measured.picture(figure)
    figure.savefig(path, metadata={"Date": None})
