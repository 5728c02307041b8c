"""``insonify stability``: where methods fail, measured here, as one page."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from insonify.commands.options import output, say

if TYPE_CHECKING:
    from insonify.accuracy.stability import Case

SUFFIXES = (".html", ".htm")


def register(subparsers: Any) -> None:
    """Add ``stability``."""
    parser = subparsers.add_parser(
        "stability",
        help="show where methods fail, and what is done instead, as a page (.html)",
        description="Set up every place where methods of this kind are known to fail, measure the plain way and the "
        "program's own against the truth, and write a page with a table and pictures.",
    )
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="page to write: .html")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure and write.

    Returns
    -------
    int
        Exit code.
    """
    path = output(arguments.output, SUFFIXES)
    from tqdm import tqdm

    from insonify.accuracy.stability import CASES
    from insonify.accuracy.stability.report import write_report

    with tqdm(total=sum(map(len, CASES.values())), unit="case", disable=None, leave=False) as bar:

        def advance(case: Case) -> None:
            bar.set_postfix_str(case.name)
            bar.update()

        outcomes = write_report(path, CASES, done=advance)
    held = sum(outcome.is_held and outcome.is_shown for outcome in outcomes)
    say(f"{path}: {held} of {len(outcomes)} cases hold")
    return 0
