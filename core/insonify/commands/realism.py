"""``insonify realism``: what tells two folders of images apart."""

import argparse
from pathlib import Path
from typing import Any

from insonify.commands.options import add_output, chosen_output, say


def register(subparsers: Any) -> None:
    """Add ``realism``."""
    parser = subparsers.add_parser(
        "realism",
        description="Measure greys, correlation, spectrum and local patterns of the images in two folders, and print "
        "how far their distributions differ. Where scikit-learn is installed, a classifier tries to tell the two apart "
        "by all of it and by each group: an area under the curve (AUC) of 0.5 means that it cannot, 1 that it always "
        "can.",
        epilog="example: insonify realism real-seabed set/train/images -o realism.png",
    )
    parser.add_argument("folders", nargs=2, metavar="FOLDER", help="folder of images; its subfolders are searched too")
    add_output(parser, (".png",), required=False)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Print both tables, and draw the picture."""
    path = chosen_output(arguments) if arguments.output else None
    # lazy: the other commands need none of it
    from insonify.accuracy.realism import compare_textures, draw_realism, read_images
    from insonify.io.atomic import replacing

    first, second = (read_images(Path(folder)) for folder in arguments.folders)
    found = compare_textures(first, second)
    for name, count in zip(arguments.folders, found.counts):
        say(f"{name}: {count} images")
    say(*found.lines())
    if path is not None:
        with replacing(path) as beside:
            draw_realism(beside, found, (first, second), tuple(arguments.folders))
        say(str(path))
