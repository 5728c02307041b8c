"""``insonify scenes``: list the bundled scenes, or describe some."""

import argparse
import textwrap
from typing import Any

from insonify.commands.options import say
from insonify.scene import Scene, bundled_scenes, load_scene

LINE = 96  # characters


def register(subparsers: Any) -> None:
    """Add ``scenes``."""
    scenes = subparsers.add_parser(
        "scenes",
        description="List the bundled scenes. With names, describe what those scenes show and which fields to change.",
    )
    scenes.add_argument("names", nargs="*", metavar="NAME", help="a bundled scene, or a TOML file")
    scenes.set_defaults(run=run)


def about(scene: Scene) -> str:
    """Title and description of a scene, wrapped to a terminal."""
    return "\n".join([scene.title, *textwrap.wrap(scene.about, LINE, initial_indent="  ", subsequent_indent="  ")])


def run(arguments: argparse.Namespace) -> None:
    """Print names and titles of all scenes, or the descriptions of some."""
    if arguments.names:
        say("\n\n".join(about(load_scene(name)) for name in arguments.names))
        return
    names = bundled_scenes()
    width = max(map(len, names), default=0)
    for name in names:
        say(f"{name:<{width}}  {load_scene(name).title}")
