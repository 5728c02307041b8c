"""Options that the sub-commands share: scene, method, output; progress and printed lines."""

import argparse
import math
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from itertools import chain, count, repeat
from pathlib import Path
from typing import Any, TypeVar

from insonify.errors import is_count
from insonify.files import bundled_specifications
from insonify.io.atomic import NEW, temporary_path
from insonify.io.records import RECORDS
from insonify.operating_system import fault_of_path
from insonify.progress import report_progress, report_waiting
from insonify.scene import DEFAULT_SCENE, Scene, SceneError, edit, load_scene, plain, read_setting
from insonify.scene.files import named_paths

Block = TypeVar("Block")
NO_WINDOW = 3  # exit code where a picture stands in for the window that cannot be opened
FALLBACK = "insonify.png"  # its name, if none is given and there is no such file


def add_scene(parser: argparse.ArgumentParser, *, optional: bool = False) -> None:
    """Add the options for a scene and its settings."""
    explained = "name of a bundled scene (see 'insonify scenes') or a TOML file"
    default: dict[str, Any] = {"nargs": "?", "default": DEFAULT_SCENE} if optional else {}
    parser.add_argument("scene", metavar="SCENE", help=explained, **default)
    add_many(parser, "--set", "PATH=VALUE", "set a field of the scene, e.g. sonar.beam.width=2.5")
    parser.add_argument("--seed", metavar="N", help="same as --set seed=N")


def add_many(parser: argparse.ArgumentParser, option: str, written: str, explained: str) -> None:
    """Add an option that may be given several times."""
    parser.add_argument(option, action="append", default=[], metavar=written, help=f"{explained}; repeatable")


def add_method(parser: argparse.ArgumentParser) -> None:
    """Add the options for method, tolerance and model choices."""
    parser.add_argument(
        "--method",
        choices=_Methods(),
        default="auto",
        metavar="METHOD",
        help="how echoes are computed: %(choices)s (default: %(default)s)",
    )
    parser.add_argument(
        "--tolerance", type=_share, default=0.03, metavar="E", help="relative error to accept (default: %(default)s)"
    )
    example = "planes=16 or bending=off"
    add_many(parser, "--model", "SUBJECT=CHOICE", f"set a choice of the plan yourself, e.g. {example}")


SIDES = ("port", "starboard")


def find_pixel(scene: Scene, ping: int, side: str, slant_range: float) -> tuple[int, int, int]:
    """Find a pixel of a scene's record."""
    pings, sonar = scene.track.pings, scene.sonar
    if not 0 <= ping < pings:
        raise SceneError(f"ping {ping}: the track has {pings} pings; give a number from 0 to {pings - 1}")
    if side not in SIDES:
        raise SceneError(f"side {side!r} is not known; choose port or starboard")
    if not 0.0 <= slant_range < sonar.range:
        raise SceneError(f"range {slant_range:g} m is outside the record; give one from 0 to {sonar.range:g} m")
    return ping, SIDES.index(side), min(int(slant_range / sonar.range * sonar.bins), sonar.bins - 1)


def add_threads(parser: argparse.ArgumentParser) -> None:
    """Add the option that limits the threads."""
    parser.add_argument(
        "--threads",
        type=_count,
        metavar="N",
        help="maximum number of threads, e.g. 2 (default: INSONIFY_THREADS, or the cores that the process may use)",
    )


def add_specification(parser: argparse.ArgumentParser, folder: str, what: str) -> None:
    """Add the options of a command that does the jobs of a specification: file, folder and scheduler."""
    names = ", ".join(bundled_specifications(folder))
    parser.add_argument("specification", metavar="SPEC", help=f"a TOML file, or a bundled specification: {names}")
    parser.add_argument("-o", "--output", required=True, metavar="DIR", help=f"folder of the {what}")
    parser.add_argument(
        "--scheduler",
        default="local",
        metavar="WHERE",
        help="where jobs run: local:N for N workers on this machine, or tcp://HOST:PORT of a dask scheduler; its "
        "workers must share the folder (default: local, with one worker for each core that the process may use)",
    )


class _Methods:
    """Names of the methods, read when they are needed: the planner takes half of the time to load a command."""

    def __iter__(self) -> Iterator[str]:
        # lazy: not every command plans
        from insonify.tracers.base import list_methods

        return iter(list_methods())


def chosen_method(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return method, tolerance and model choices as arguments of `insonify.planning.plan`."""
    forced = {}
    for text in arguments.model:
        subject, equals, choice = text.partition("=")
        if not equals:
            raise SceneError(f"--model {text}: there is no '='; write SUBJECT=CHOICE, such as planes=16 or bending=off")
        forced[subject.strip()] = choice.strip()
    return {"method": arguments.method, "tolerance": arguments.tolerance, "forced": forced}


def is_record(name: str) -> bool:
    """Whether a name is, by its suffix, the file of a record rather than a scene."""
    return Path(name).suffix.lower() in (*RECORDS.readable(), *RECORDS.suffixes("converter"))


def add_frequency(parser: argparse.ArgumentParser) -> None:
    """Add the option that selects the frequency of a recording with several."""
    parser.add_argument(
        "--frequency", type=_number, metavar="HZ", help="carrier frequency of a recording with several, e.g. 400e3"
    )


def chosen_scene(arguments: argparse.Namespace) -> Scene:
    """Load the scene, apply all settings, then validate."""
    if is_record(arguments.scene):
        name = arguments.scene
        if Path(name).suffix.lower() in RECORDS.suffixes("converter"):
            RECORDS.format_of(name)
        raise SceneError(f"{name}: this is a record, not a scene; draw it with 'insonify render {name} -o OUT.png'")
    scene = load_scene(arguments.scene)
    changes = dict(read_setting(text) for text in arguments.set)
    written = getattr(arguments, "output", None) or getattr(arguments, "snapshot", None)
    if written:
        _refuse_overwriting(written, named_paths(plain(scene)))
    seed = getattr(arguments, "seed", None)  # the viewer's own commands may lack it
    if seed is not None:
        changes |= dict([read_setting(f"seed={seed}")])
    return edit(scene, changes) if changes else scene


def add_output(
    parser: argparse.ArgumentParser, suffixes: tuple[str, ...], explained: str | None = None, *, required: bool = True
) -> None:
    """Add the option for the file to write."""
    help_text = f"file to write: {explained or ', '.join(suffixes)}"
    parser.add_argument("-o", "--output", required=required, metavar="OUT", help=help_text)
    parser.set_defaults(suffixes=suffixes)


def chosen_output(arguments: argparse.Namespace) -> Path:
    """Return the path of the file to write, checked as in `check_output`."""
    named = [value for name, value in vars(arguments).items() if name != "output"]
    words = (word for value in named for word in (value if isinstance(value, list) else [value]))
    path = check_output(arguments.output, arguments.suffixes)
    _refuse_overwriting(arguments.output, (word for word in words if isinstance(word, str)))
    return path


def check_output(name: str, suffixes: tuple[str, ...], option: str = "-o") -> Path:
    """Return the path of an output after checking that it can be written."""
    path, where = Path(name), f"{option} {name}"
    # A folder may be replaced if it is a record that Zarr made, or an empty one.
    of_records = path.suffix.lower() in RECORDS.suffixes("folder")
    if path.is_dir() and not (of_records and ((path / "zarr.json").is_file() or not any(path.iterdir()))):
        raise SceneError(f"{where}: is a folder; give the name of a file in it")
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise SceneError(f"{where}: is a device, not a file; give another name")
    if path.suffix.lower() not in suffixes:
        raise SceneError(
            f"{where}: {path.suffix!r} is not written by this command; end the name in {' or '.join(suffixes)}"
        )
    # The target of a link is replaced, so it must have the same suffix: a scene must not become a record.
    leads_to = Path(os.path.realpath(path))
    if path.is_symlink() and (leads_to.is_symlink() or leads_to.suffix.lower() != path.suffix.lower()):
        raise SceneError(f"{where}: is a link to {os.readlink(path)!r}, which is no {path.suffix}; give another name")
    if fault := fault_of_path(path) or fault_of_path(temporary_path(path) / f"{NEW}{path.suffix}"):
        raise SceneError(f"{where}: {fault}; give another name")
    if not path.parent.is_dir():
        raise SceneError(f"{where}: there is no folder {str(path.parent)!r}; create it or give another name")
    # Checked before the work starts. A protected file is kept even where its folder permits replacing it.
    locked = next((place for place in (path, path.parent) if place.exists() and not os.access(place, os.W_OK)), None)
    if locked is not None:
        raise SceneError(f"{where}: {str(locked)!r} is write-protected; allow writing or give another name")
    return path


def _refuse_overwriting(output: str, read: Iterable[str]) -> None:
    """Refuse an output that is one of the files that are read."""
    if any(map(_is_same_file, repeat(output), read)):
        raise SceneError(f"-o {output}: is also an input of this command; give another name")


def _is_same_file(one: str, other: str) -> bool:
    try:
        return os.path.samefile(one, other)
    except (OSError, ValueError):  # one of them is no file
        return False


def free_name(name: str) -> str:
    """Return the name of a file that does not exist yet: the given one, or one with a number."""
    stem, suffix = os.path.splitext(name)
    numbered = (f"{stem}-{number}{suffix}" for number in count(2))
    return next(free for free in chain([name], numbered) if not os.path.lexists(free))


def tracked(blocks: Iterator[Block], total: int, count: Callable[[Block], int], unit: str = "ping") -> Iterator[Block]:
    """Yield blocks, of pings or another unit; a terminal shows their progress after a second of work."""
    with report_waiting():
        block = next(blocks, None)  # makes the bed and the plan, where they have not been made
    with report_progress("", total, unit, delay=1.0) as progress:
        while block is not None:
            yield block
            progress.advance(count(block))
            block = next(blocks, None)


def level_line(name: str, level: float, detail: str = "") -> str:
    """Line of a level in decibels with its name."""
    # Rounded first, so that no "-0.00" is printed.
    number = f"{round(level, 2) + 0.0:>10.2f} dB" if math.isfinite(level) else f"{'no echo':>10}"
    return f"{name:<22}{number}  {detail}".rstrip()


def say(*lines: str) -> None:
    """Write lines to standard output."""
    sys.stdout.writelines(f"{line}\n" for line in lines)


def _count(text: str) -> int:
    if not (is_count(text) and int(text) > 0):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of threads; give a whole number from 1")
    return int(text)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number; give a plain number") from None


def bounded(low: float, high: float, remedy: str) -> Callable[[str], float]:
    """Parser of a number between bounds."""

    def parse(text: str) -> float:
        value = _number(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text} is out of bounds; give {remedy}")
        return value

    return parse


decibels = bounded(-200.0, 200.0, "decibels from -200 to 200")
metres = bounded(1e-3, 1e6, "metres from 0.001 to 1000000")
_share = bounded(math.ulp(0.0), 1.0, "a number above 0 and at most 1, e.g. 0.03")
