"""What the viewer adds to the ``insonify`` command; Qt is imported only when it runs."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import Any

from insonify.scene import DEFAULT_SCENE, Scene, SceneError, edit, load_scene, read_setting
from insonify_viewer.display import why_no_window

FALLBACK = "insonify.png"


def register(subparsers: Any) -> None:
    """Add ``view`` to the sub-commands of ``insonify``."""
    parser = subparsers.add_parser("view", help="open the viewer", description="Open the viewer on a scene.")
    add_arguments(parser)
    parser.set_defaults(run=run)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add what the viewer can be told."""
    parser.add_argument("scene", nargs="?", default=DEFAULT_SCENE, help="bundled scene or TOML file")
    parser.add_argument("--snapshot", metavar="PNG", help="draw the window into a picture instead of opening it")
    parser.add_argument(
        "--set", action="append", default=[], metavar="PATH=VALUE", help="change the scene; may be repeated"
    )


def run(arguments: argparse.Namespace) -> int:
    """Open the viewer, or draw its window into a picture where it cannot be opened.

    Parameters
    ----------
    arguments : Namespace
        ``scene``, ``snapshot`` and ``set``, where given.

    Returns
    -------
    int
        Exit code.
    """
    scene = _scene(arguments)
    snapshot = getattr(arguments, "snapshot", None)
    reason = why_no_window()
    if snapshot is None and reason:
        snapshot = FALLBACK
    if snapshot is None:
        from insonify_viewer.application import open_window

        return open_window(scene)
    path = picture_path(snapshot)
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    from insonify_viewer.application import draw_window

    draw_window(scene, path)
    if getattr(arguments, "snapshot", None) is None:
        sys.stdout.write(f"No window can be opened ({reason}); the window was drawn into {path} instead.\n")
    return 0


def picture_path(name: str) -> Path:
    """Check that a picture can be written there.

    Raises
    ------
    SceneError
        One sentence with the remedy.
    """
    path = Path(name)
    if path.suffix.lower() != ".png":
        raise SceneError(f"--snapshot {name!r}: the picture is a PNG; give a name that ends in .png")
    if not path.parent.is_dir():
        raise SceneError(f"--snapshot {name!r}: there is no folder {str(path.parent)!r}; create it first")
    if path.is_dir():
        raise SceneError(f"--snapshot {name!r}: this is a folder; give the name of a file in it")
    return path


def _scene(arguments: argparse.Namespace) -> Scene:
    scene = load_scene(getattr(arguments, "scene", None) or DEFAULT_SCENE)
    settings = dict(read_setting(text) for text in getattr(arguments, "set", None) or [])
    return edit(scene, settings) if settings else scene
