"""``insonify plan``: how a scene would be simulated, why, and at what cost."""

import argparse
from typing import Any

from insonify.commands.options import add_method, add_scene, chosen_method, chosen_scene, say
from insonify.progress import report_waiting


def register(subparsers: Any) -> None:
    """Add ``plan``."""
    parser = subparsers.add_parser(
        "plan",
        description="Simulate a scene and state the error found, the planes across the beam that its pings take, the "
        "cost, which effects are modelled and left out, what each changes, and why no cheaper model is taken. Then "
        "list the numbers of the bed's materials, and their misfit to the models of backscatter.",
    )
    add_scene(parser)
    add_method(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print the plan of a scene."""
    # lazy: not every command plans
    from insonify.acoustics.bed_materials import describe_materials
    from insonify.explanation.plan_page import write_plan_page

    scene = chosen_scene(arguments)
    with report_waiting():
        page = write_plan_page(scene, **chosen_method(arguments))
    say(*page)
    for number, line in enumerate([*describe_materials(scene), *scene.describe_limits()]):
        say(line if number else f"\n{line}")
