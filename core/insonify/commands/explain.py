"""``insonify explain``: the terms, in decibels, that add up to one pixel of a record."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from insonify.commands import options
from insonify.progress import report_waiting

if TYPE_CHECKING:
    from insonify.explanation.pixel import PixelExplanation

MOST_PRINTED = 4  # contributions and obstructions that are printed


def register(subparsers: Any) -> None:
    """Add ``explain``."""
    parser = subparsers.add_parser(
        "explain",
        description="Describe what one pixel of a record shows or why it is dark. Print the terms in dB that add up to "
        "it, the sources of its echo and what hides the bed there. Example: insonify explain default --ping 230 "
        "--range 25",
    )
    options.add_scene(parser)
    options.add_method(parser)
    parser.add_argument("--ping", type=int, required=True, metavar="N", help="number of the ping, from 0")
    parser.add_argument("--side", choices=options.SIDES, default="port", help="default: %(default)s")
    parser.add_argument("--range", type=float, required=True, metavar="M", help="slant range of the pixel, m")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Explain one pixel."""
    # lazy: loads Numba, which other commands do without
    from insonify.explanation.pixel import explain_pixel
    from insonify.simulation import prepare

    scene = options.chosen_scene(arguments)
    pixel = options.find_pixel(scene, arguments.ping, arguments.side, arguments.range)
    with report_waiting():
        simulation = prepare(scene, **options.chosen_method(arguments))
    options.say(*_table(explain_pixel(simulation, *pixel)))


def _table(explained: PixelExplanation) -> list[str]:
    """Lines that print an explanation."""
    side = options.SIDES[explained.side]
    lines = [f"ping {explained.ping}, {side}, {explained.slant_range:.2f} m: {explained.summary}", ""]
    lines += [options.level_line(term.name, term.decibels, term.detail) for term in explained.terms]
    lines.append(options.level_line("pixel", explained.level))
    for each in explained.contributions[:MOST_PRINTED]:
        lines.append(f"{100.0 * each.share:>6.1f} % {each.words}, at {each.ground_range:.2f} m")
    for hidden in explained.obstructions[:MOST_PRINTED]:
        lines.append(f"{100.0 * hidden.share:>6.1f} % hidden by {hidden.hider}")
    if explained.obstructions and math.isfinite(explained.unhidden):
        lines.append(options.level_line("with nothing hidden", explained.unhidden))
    return [*lines, *explained.approximations]
