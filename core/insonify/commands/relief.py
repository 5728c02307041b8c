"""``insonify relief``: the heights of the bed as a grey picture."""

import argparse
from typing import Any

from insonify.commands.options import add_output, add_scene, chosen_output, chosen_scene, say
from insonify.progress import report_waiting


def register(subparsers: Any) -> None:
    """Add ``relief``."""
    parser = subparsers.add_parser(
        "relief",
        description="Write the heights of the bed of a scene as a PNG: the lowest black, the highest white, north up.",
    )
    add_scene(parser)
    add_output(parser, (".png",))
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Write the heights of the bed of a scene as a grey picture."""
    path = chosen_output(arguments)
    scene = chosen_scene(arguments)
    from PIL import Image

    # lazy: the other commands need no kernels of relief
    from insonify.io.atomic import replacing
    from insonify.terrain import relief_picture

    with report_waiting("making the bed"):
        picture = relief_picture(scene)
    with replacing(path) as beside:
        Image.fromarray(picture).save(beside)
    say(f"{path}: {picture.shape[1]} x {picture.shape[0]} pixels")
