"""``insonify light``: a scene as light shows it."""

import argparse
from typing import Any

from insonify.commands.options import add_output, add_scene, add_threads, chosen_output, chosen_scene, say


def register(subparsers: Any) -> None:
    """Add ``light``."""
    parser = subparsers.add_parser(
        "light",
        description="Draw the seabed and the targets, lit by a lamp at the sonar half way along the track. The scene's "
        "own materials return the light (Lambert and Phong); shadows are hard.",
    )
    add_scene(parser)
    add_output(parser, (".png",))
    add_threads(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Draw a scene by light and write the picture."""
    path = chosen_output(arguments)
    scene = chosen_scene(arguments)
    # lazy: the other commands need neither Matplotlib nor the kernels
    from insonify.optics.cutaway import make_optical_scene
    from insonify.optics.light import write_light
    from insonify.parallel import limited_threads

    with limited_threads(arguments.threads):
        width, height = write_light(path, make_optical_scene(scene))
    say(f"{path}: {width} x {height} pixels")
