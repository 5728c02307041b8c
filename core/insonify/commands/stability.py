"""``insonify stability``: a page of the known numerical failures, measured on this machine."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from insonify.commands.options import add_output, chosen_output, say
from insonify.progress import report_progress

if TYPE_CHECKING:
    from insonify.accuracy.stability import StabilityCase


def register(subparsers: Any) -> None:
    """Add ``stability``."""
    parser = subparsers.add_parser(
        "stability",
        description="Set up the cases in which methods of this kind are known to fail. Measure the plain method and "
        "the program's own against the exact answer, and write a page with a table and figures.",
    )
    add_output(parser, (".html", ".htm"))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Measure the cases of numerical failure and write the page."""
    path = chosen_output(arguments)
    # lazy: every method and every drawing
    from insonify.accuracy.stability import CASES
    from insonify.accuracy.stability.report import write_report

    with report_progress("", sum(map(len, CASES.values())), "case") as progress:

        def advance(case: StabilityCase) -> None:
            progress.say(case.name)
            progress.advance(1)

        outcomes = write_report(path, CASES, done=advance)
    held = sum(outcome.holds for outcome in outcomes)
    say(f"{path}: {held} of {len(outcomes)} cases hold")
