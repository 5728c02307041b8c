"""``insonify render``: scene in, record or picture out."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from insonify.commands.options import add_method, add_scene, chosen_scene, decibels, output, say, tracked
from insonify.look import PALETTES, SIDES, Look
from insonify.scene import Scene, SceneError

SUFFIXES = (".png", ".nc", ".npz")


def register(subparsers: Any) -> None:
    """Add ``render``."""
    parser = subparsers.add_parser(
        "render",
        help="simulate a record: a picture (.png), netCDF (.nc) or NumPy (.npz)",
        description="Simulate a scene's record and write it by suffix: .png a picture, .nc netCDF, .npz NumPy arrays. "
        "NetCDF is written as it is made, so a tow of any length fits.",
    )
    add_scene(parser)
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="file to write: .png, .nc or .npz")
    picture = parser.add_argument_group("pictures")
    picture.add_argument("--palette", choices=PALETTES, help="colours (default: copper)")
    picture.add_argument("--side", choices=SIDES, help="channels shown (default: both)")
    picture.add_argument("--ground-range", action="store_true", help="straighten slant range into ground range")
    picture.add_argument("--gain", type=decibels, metavar="DB", help="brighten by so many decibels (default: 0)")
    add_method(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Simulate and write.

    Returns
    -------
    int
        Exit code.
    """
    path = output(arguments.output, SUFFIXES)
    scene = chosen_scene(arguments)
    given = {name: getattr(arguments, name) for name in Look._fields if getattr(arguments, name) not in (None, False)}
    if given and path.suffix.lower() != ".png":
        option = f"--{next(iter(given)).replace('_', '-')}"
        raise SceneError(f"{option} is for pictures, not {path.name}; leave it out or end the name in .png")
    write(scene, path, Look(**given), method=arguments.method, tolerance=arguments.tolerance)
    say(f"{path}: {scene.track.pings} pings of 2 x {scene.sonar.bins} bins")
    return 0


def write(scene: Scene, path: Path, look: Look, *, method: str = "auto", tolerance: float = 0.03) -> None:
    """Simulate a scene and write it by suffix.

    Parameters
    ----------
    scene : Scene
    path : Path
        Ends in one of ``SUFFIXES``; appears only when whole.
    look : Look
        For pictures.
    method : str
    tolerance : float
    """
    from insonify.simulate import simulate, simulate_blocks

    pings = scene.track.pings
    if path.suffix.lower() == ".npz":
        from insonify.records import write_npz

        write_npz(path, simulate(scene, method=method, tolerance=tolerance))
        return
    blocks = tracked(simulate_blocks(scene, method=method, tolerance=tolerance), pings)
    if path.suffix.lower() == ".nc":
        from insonify.records import write_netcdf

        write_netcdf(path, blocks)
        return
    from insonify.page import write_page
    from insonify.picture import display_curve
    from insonify.sheet import gather
    from insonify.simulate import prepare

    curve = display_curve(prepare(scene, method=method, tolerance=tolerance))
    write_page(path, gather(blocks, curve, pings, look), look, scene)
