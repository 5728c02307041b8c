"""``insonify render``: a scene or a record in, a record or a picture out."""

import argparse
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from insonify.commands import options
from insonify.display.display_options import PALETTES, SIDES, DisplayOptions, read_display
from insonify.io.record_schema import split_record
from insonify.io.records import RECORDS, read_record, write_record
from insonify.progress import report_waiting
from insonify.scene import Scene, SceneError

PICTURE = ".png"
Tracker = Callable[[Iterator[Any], int, Callable[[Any], int]], Iterator[Any]]


def register(subparsers: Any) -> None:
    """Add ``render``."""
    written = RECORDS.describe(RECORDS.writable())
    parser = subparsers.add_parser(
        "render",
        description="Simulate the record of a scene and write it in the format of its suffix. NetCDF, Zarr, XTF and "
        "JSF are written block by block, so memory does not grow with the number of pings. A record may stand in place "
        f"of the scene: {RECORDS.describe(RECORDS.readable())}. It is drawn, or written in another format, as it is.",
        epilog="examples: insonify render wreck -o wreck.xtf --bits 8; "
        "insonify render targets -o labelled.nc --truth; "
        "insonify render recording.jsf -o high.png --frequency 900e3",
    )
    options.add_scene(parser)
    options.add_frequency(parser)
    options.add_output(parser, (PICTURE, *RECORDS.writable()), f"{PICTURE} (picture), {written}")
    picture = parser.add_argument_group("pictures")
    picture.add_argument("--palette", choices=PALETTES, help="colour map (default: copper)")
    picture.add_argument("--side", choices=SIDES, help="channels to draw (default: both)")
    picture.add_argument("--ground-range", action="store_true", help="convert slant range to ground range")
    picture.add_argument(
        "--gain", type=options.decibels, metavar="DB", help="brighten by this many decibels (default: 0)"
    )
    picture.add_argument(
        "--display",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="another option of pictures, as in the viewer: water_column=false, decibels=true, reverse=true, "
        "levels=[0.1,4], side_gains=[0,6], bottom_line=true, range_lines=true, newest_on_top=false; repeatable",
    )
    files = parser.add_argument_group("files")
    files.add_argument(
        "--truth",
        action="store_true",
        help="label every bin (target, material, shadow, path), and give for every target the boxes of its echo and "
        f"its shadow, its shadow length and its target strength ({', '.join(RECORDS.suffixes('labelled'))})",
    )
    files.add_argument(
        "--error",
        action="store_true",
        help="add the estimated error of every bin, in the unit of the intensity; that of every ping is always there "
        f"({', '.join(RECORDS.suffixes('labelled'))})",
    )
    for option in RECORDS.options():
        default = f"{option.description} (default: {option.choices[0]})"
        files.add_argument(f"--{option.name}", choices=option.choices, help=default)
    options.add_method(parser)
    options.add_threads(parser)
    parser.set_defaults(run=run, default_of=parser.get_default)


def run(arguments: argparse.Namespace) -> None:
    """Simulate a scene or read a record, and write the record or its picture."""
    path = options.chosen_output(arguments)
    look = _display_options(arguments, path)
    given = next((name for name in ("truth", "error") if getattr(arguments, name)), None)
    if given is not None and path.suffix.lower() not in RECORDS.suffixes("labelled"):
        labelled = ", ".join(RECORDS.suffixes("labelled"))
        raise SceneError(
            f"--{given} applies to {labelled}, not to {path.name}; leave it out or end the name in one of them"
        )
    choices = _write_options(arguments, path)
    if options.is_record(arguments.scene):
        pings, bins = _render_record(arguments, path, look, choices)
    else:
        scene = options.chosen_scene(arguments)
        if arguments.frequency is not None:
            raise SceneError("--frequency applies to recordings; write --set sonar.frequency=… for a scene")
        settings = options.chosen_method(arguments) | {"threads": arguments.threads}
        write(scene, path, look, choices, truth=arguments.truth, bin_error=arguments.error, **settings)
        pings, bins = scene.track.pings, scene.sonar.bins
    options.say(f"{path}: {pings} pings of 2 x {bins} bins")


def _display_options(arguments: argparse.Namespace, path: Path) -> DisplayOptions:
    """Return how a picture is drawn; raise SceneError for options of pictures with another file."""
    flags = {name: getattr(arguments, name, None) for name in DisplayOptions._fields}
    given = {name: value for name, value in flags.items() if value not in (None, False)}
    if (given or arguments.display) and not _is_picture(path):
        option = f"--{next(iter(given)).replace('_', '-')}" if given else "--display"
        raise SceneError(f"{option} applies to pictures, not to {path.name}; leave it out or end the name in {PICTURE}")
    return DisplayOptions(**given | read_display(arguments.display))


def _write_options(arguments: argparse.Namespace, path: Path) -> dict[str, str]:
    """Return the given choices of the file's format; raise SceneError for choices of another format."""
    given = {
        option.name: value for option in RECORDS.options() if (value := getattr(arguments, option.name)) is not None
    }
    known = {option.name for option in RECORDS.options(path.suffix)}
    strange = next((name for name in given if name not in known), None)
    if strange is not None:
        raise SceneError(f"--{strange} is not an option of {path.suffix} files such as {path.name}; leave it out")
    return given


def _render_record(
    arguments: argparse.Namespace, path: Path, look: DisplayOptions, choices: Mapping[str, str]
) -> tuple[int, int]:
    """Read a record and write it by suffix; return its pings and bins."""
    of_scenes = ("set", "seed", "method", "tolerance", "model", "threads", "truth", "error")
    changed = next((name for name in of_scenes if getattr(arguments, name) != arguments.default_of(name)), None)
    if changed is not None:
        raise SceneError(f"--{changed} applies to scenes, and {arguments.scene} is a record; leave it out")
    record = read_record(arguments.scene, arguments.frequency)
    if not _is_picture(path):
        write_record(path, (record.isel(ping_time=some) for some in split_record(record)), **choices)
    else:
        # lazy: the other commands need neither Matplotlib nor the kernels
        from insonify.display.page import caption_record, write_page
        from insonify.display.sheet import gather_record_sheet

        sheet = gather_record_sheet(record, look)
        write_page(path, sheet, look, caption_record(record, sheet.along, look))
    return record.sizes["ping_time"], record.sizes["range_sample"]


def write(
    scene: Scene,
    path: Path,
    look: DisplayOptions,
    choices: Mapping[str, str] | None = None,
    *,
    truth: bool = False,
    bin_error: bool = False,
    track: Tracker = options.tracked,
    **settings: Any,
) -> None:
    """Simulate a scene, by arguments of `insonify.simulation.prepare`, and write its record or picture."""
    # lazy: the other commands need neither Matplotlib nor the kernels
    from insonify.parallel import one_ahead
    from insonify.simulation import prepare, simulate_record_blocks

    pings = scene.track.pings
    if not _is_picture(path):
        blocks = one_ahead(simulate_record_blocks(scene, **settings, truth=truth, bin_error=bin_error))
        write_record(path, track(blocks, pings, lambda block: block.sizes["ping_time"]), **(choices or {}))
        return
    # lazy: the other commands need no kernels
    from insonify.display.normalisation import LevelBed
    from insonify.display.sheet import gather_sheet, trace_sheet_pings

    # Without Datasets: importing xarray and pandas takes as long as the picture.
    with report_waiting():
        simulation = prepare(scene, **settings)
    shown = track(one_ahead(trace_sheet_pings(simulation)), pings, lambda block: len(block.intensity))
    sheet = gather_sheet(shown, LevelBed(simulation).normalise, pings, look)
    # lazy: Matplotlib takes as long to import as all before the first ping, and only the finished sheet needs it
    from insonify.display.page import caption_scene, write_page

    write_page(path, sheet, look, caption_scene(scene, look))


def _is_picture(path: Path) -> bool:
    return path.suffix.lower() == PICTURE
