"""``insonify plan`` and ``insonify scenes``: what would be done, and what there is."""

from __future__ import annotations

import argparse
from typing import Any

from insonify.commands.options import add_method, add_scene, chosen_scene, say
from insonify.scene import bundled_scenes, load_scene


def register(subparsers: Any) -> None:
    """Add ``plan`` and ``scenes``."""
    plan = subparsers.add_parser(
        "plan",
        help="say how a scene would be simulated and why",
        description="Say what is modelled, what is left out, why, and at what cost.",
    )
    add_scene(plan)
    add_method(plan)
    plan.set_defaults(run=run_plan)
    scenes = subparsers.add_parser(
        "scenes", help="list the bundled scenes", description="List the scenes that come with insonify."
    )
    scenes.set_defaults(run=run_scenes)


def run_plan(arguments: argparse.Namespace) -> int:
    """Print the plan of a scene.

    Returns
    -------
    int
        Exit code.
    """
    from insonify.plan import plan

    for line in plan(chosen_scene(arguments), arguments.tolerance, method=arguments.method).lines():
        say(line)
    return 0


def run_scenes(arguments: argparse.Namespace) -> int:
    """Print names and titles.

    Returns
    -------
    int
        Exit code.
    """
    names = bundled_scenes()
    width = max(map(len, names), default=0)
    for name in names:
        say(f"{name:<{width}}  {load_scene(name).title}")
    return 0
