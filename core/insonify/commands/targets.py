"""``insonify targets``: list the library of targets."""

import argparse
from typing import Any

from insonify.commands.options import say
from insonify.files import bundled_targets
from insonify.scene.targets.mesh import MeshFile


def register(subparsers: Any) -> None:
    """Add ``targets``."""
    parser = subparsers.add_parser(
        "targets",
        description="List the library of targets: name, length, width and height in metres, and what it is. A name is "
        "the path of a mesh.",
        epilog='example: insonify render default --set targets.1=\'{kind = "mesh", path = "drum", '
        "position = [62.0, -18.0]}' -o drum.png",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print a line for every target of the library."""
    library = bundled_targets()
    width = max(map(len, library))
    for name, title in library.items():
        half = MeshFile(path=name, position=(0.0, 0.0)).outline.half
        size = " x ".join(f"{2.0 * side:.2f}" for side in half)
        say(f"{name:<{width}}  {size} m  {title}")
