"""``insonify chart``: speed against accuracy, measured on this machine."""

import argparse
from typing import Any

from insonify.accuracy.charts.kinds import list_chart_kinds, load_chart_kind
from insonify.commands.options import add_output, add_scene, chosen_output, chosen_scene, say
from insonify.progress import report_progress


def register(subparsers: Any) -> None:
    """Add ``chart``."""
    parser = subparsers.add_parser(
        "chart",
        description="Run every method on a scene on this machine. Chart the time per ping against the error, the cost "
        "against the number of pings, cells, bins, targets, planes and rays, or the error against step size or count.",
    )
    add_scene(parser, optional=True)
    parser.add_argument(
        "--of", choices=list_chart_kinds(), default="accuracy", help="kind of chart (default: %(default)s)"
    )
    add_output(parser, (".png", ".svg", ".csv", ".json"))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Measure a scene on this machine and write the chart."""
    path = chosen_output(arguments)
    scene = chosen_scene(arguments)
    measure = load_chart_kind(arguments.of)
    with report_progress("measuring", 1.0, delay=1.0) as progress:
        measured = measure(scene, progress=progress.reach)
    measured.save(path)
    say(*measured.summarise(), str(path))
