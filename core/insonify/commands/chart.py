"""``insonify chart``: speed against accuracy, measured here."""

from __future__ import annotations

import argparse
from typing import Any

from insonify.commands.options import add_scene, chosen_scene, output, say

SUFFIXES = (".png", ".svg", ".csv", ".json")


def register(subparsers: Any) -> None:
    """Add ``chart``."""
    parser = subparsers.add_parser(
        "chart",
        help="measure speed against accuracy on this machine",
        description="Measure time per ping and error of every method on a scene, on this machine.",
    )
    add_scene(parser, optional=True)
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="file to write: .png, .svg, .csv or .json")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure and write.

    Returns
    -------
    int
        Exit code.
    """
    path = output(arguments.output, SUFFIXES)
    scene = chosen_scene(arguments)
    from insonify.charts import chart

    chart(scene).save(path)
    say(str(path))
    return 0
