"""``insonify render``: scene or recording in, record or picture out."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from insonify.commands.options import (
    add_method,
    add_scene,
    chosen_model,
    chosen_scene,
    decibels,
    is_record,
    output,
    say,
    tracked,
)
from insonify.display.options import PALETTES, SIDES, Look
from insonify.scene import Scene, SceneError

SUFFIXES = (".png", ".nc", ".npz")


def register(subparsers: Any) -> None:
    """Add ``render``."""
    parser = subparsers.add_parser(
        "render",
        help="simulate a record: a picture (.png), netCDF (.nc) or NumPy (.npz)",
        description="Simulate a scene's record and write it by suffix: .png a picture, .nc netCDF, .npz NumPy arrays. "
        "NetCDF is written as it is made, so a tow of any length fits. In place of a scene a record may stand, a real "
        "one (.xtf) or one written here (.nc, .npz); it is shown, or written anew, as it is.",
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
    given = {name: getattr(arguments, name) for name in Look._fields if getattr(arguments, name) not in (None, False)}
    if given and path.suffix.lower() != ".png":
        option = f"--{next(iter(given)).replace('_', '-')}"
        raise SceneError(f"{option} is for pictures, not {path.name}; leave it out or end the name in .png")
    if is_record(arguments.scene):
        pings, bins = _render_record(arguments, path, Look(**given))
    else:
        scene = chosen_scene(arguments)
        options = {"method": arguments.method, "tolerance": arguments.tolerance, "forced": chosen_model(arguments)}
        write(scene, path, Look(**given), **options)
        pings, bins = scene.track.pings, scene.sonar.bins
    say(f"{path}: {pings} pings of 2 x {bins} bins")
    return 0


def _render_record(arguments: argparse.Namespace, path: Path, look: Look) -> tuple[int, int]:
    """Read a record and write it by suffix; return its pings and bins."""
    untouched: dict[str, object] = {"set": [], "seed": None, "method": "auto", "tolerance": 0.03, "model": []}
    changed = next((name for name, value in untouched.items() if getattr(arguments, name) != value), None)
    if changed is not None:
        raise SceneError(f"--{changed} is for scenes, and {arguments.scene} is a record already; leave it out")
    from insonify.io.records import read_record, write_netcdf, write_npz

    record = read_record(arguments.scene)
    if path.suffix.lower() == ".npz":
        write_npz(path, record)
    elif path.suffix.lower() == ".nc":
        write_netcdf(path, [record])
    else:
        from insonify.display.page import record_caption, write_page
        from insonify.display.sheet import gather_record

        sheet = gather_record(record, look)
        write_page(path, sheet, look, record_caption(record, sheet.along, look))
    return record.sizes["ping_time"], record.sizes["range_sample"]


def write(
    scene: Scene,
    path: Path,
    look: Look,
    *,
    method: str = "auto",
    tolerance: float = 0.03,
    forced: Mapping[str, str] | None = None,
) -> None:
    """Simulate a scene and write it by suffix.

    Parameters
    ----------
    scene : Scene
    path : Path
        Ends in one of ``SUFFIXES``; appears only when whole.
    look : Look
        For pictures.
    method, tolerance, forced
        As in `insonify.simulate`.
    """
    from insonify.simulation import simulate, simulate_blocks

    pings = scene.track.pings
    if path.suffix.lower() == ".npz":
        from insonify.io.records import write_npz

        write_npz(path, simulate(scene, method=method, tolerance=tolerance, forced=forced))
        return
    blocks = tracked(simulate_blocks(scene, method=method, tolerance=tolerance, forced=forced), pings)
    if path.suffix.lower() == ".nc":
        from insonify.io.records import write_netcdf

        write_netcdf(path, blocks)
        return
    from insonify.display.page import scene_caption, write_page
    from insonify.display.picture import LevelBed
    from insonify.display.sheet import gather
    from insonify.simulation import prepare

    level = LevelBed(prepare(scene, method=method, tolerance=tolerance, forced=forced))
    write_page(path, gather(blocks, level.curves, pings, look), look, scene_caption(scene, look))
