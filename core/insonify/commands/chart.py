"""``insonify chart``: speed against accuracy, measured on this machine."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from insonify.accuracy.charts.kinds import list_chart_kinds, load_chart_kind
from insonify.commands.options import add_output, add_scene, chosen_output, chosen_scene, say


def register(subparsers: Any) -> None:
    """Add ``chart``."""
    parser = subparsers.add_parser(
        "chart",
        help="measure speed against accuracy on this machine",
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
    with _bar() as progress:
        measured = measure(scene, progress=progress)
    measured.save(path)
    for note in measured.summarise():
        say(note)
    say(str(path))


@contextmanager
def _bar() -> Iterator[Callable[[float], None]]:
    """Show the progress of a long measurement on a terminal."""
    from tqdm import tqdm

    with tqdm(total=100, unit="%", disable=None, delay=1.0, leave=False, bar_format="{l_bar}{bar}|") as bar:

        def progress(share: float) -> None:
            bar.update(max(round(100.0 * share) - bar.n, 0))

        yield progress
