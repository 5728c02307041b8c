"""What the viewer adds to the ``insonify`` command; libraries that draw are imported only when it runs."""

from __future__ import annotations

import argparse
import os
import sys
from typing import Any

from insonify.commands.options import add_scene, check_output, chosen_scene
from insonify_viewer.screen_check import why_no_window

FALLBACK = "insonify.png"


def register(subparsers: Any) -> None:
    """Add ``view`` to the sub-commands of ``insonify``."""
    parser = subparsers.add_parser("view", help="open the viewer", description="Open the viewer on a scene.")
    add_scene(parser, optional=True)
    parser.add_argument("--snapshot", metavar="PNG", help="draw the window into a picture instead of opening it")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Open the viewer, or draw its window into a picture where it cannot be opened.

    Parameters
    ----------
    arguments : Namespace
        The scene with its settings, and ``snapshot``.

    Returns
    -------
    int
        Exit code.
    """
    scene = chosen_scene(arguments)
    reason = why_no_window()
    if arguments.snapshot is None and not reason:
        # lazy: Qt, only when a window or a picture of it is asked for
        from insonify_viewer.application import open_window

        return open_window(scene)
    path = check_output(arguments.snapshot or FALLBACK, (".png",), "--snapshot")
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    if reason and sys.platform.startswith("linux"):
        # Else VTK would look for the display first, and complain.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    # lazy: Qt, only when a window or a picture of it is asked for
    from insonify_viewer.application import draw_window

    draw_window(scene, path)
    if arguments.snapshot is None:
        sys.stdout.write(f"No window can be opened ({reason}), so it was drawn into {path}.\n")
    return 0
