"""``insonify plan``: how a scene would be simulated, why, and at what cost."""

import argparse
from typing import Any

from insonify.commands.options import add_method, add_scene, chosen_method, chosen_scene, say
from insonify.progress import report_waiting


def register(subparsers: Any) -> None:
    """Add ``plan``."""
    parser = subparsers.add_parser(
        "plan",
        description="List the effects that are modelled and those that are left out, with the reason, the error of the "
        "record and the cost of each. Then list the numbers of the bed's materials, and their misfit to the models of "
        "backscatter.",
    )
    add_scene(parser)
    add_method(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the plan of a scene."""
    # lazy: not every command plans
    from insonify.acoustics.bed_materials import describe_materials
    from insonify.planning import plan

    scene = chosen_scene(arguments)
    with report_waiting():
        found = plan(scene, **chosen_method(arguments))
    say(found.table())
    for number, line in enumerate([*describe_materials(scene), *scene.describe_limits()]):
        say(line if number else f"\n{line}")
