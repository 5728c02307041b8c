"""``insonify view`` and ``insonify movie``: open the viewer, or draw its window into a picture or a movie."""

from __future__ import annotations

import argparse
import ctypes
import os
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from insonify.commands import options
from insonify.compiler.processes import compiled_elsewhere
from insonify.io.records import RECORDS
from insonify.io.sealed import SUFFIX
from insonify.lessons.lesson import Lesson
from insonify.scene import DEFAULT_SCENE, Scene, SceneError, edit, load_partner
from insonify_viewer.record.comparison.arrangement import Arrangement

if TYPE_CHECKING:
    from insonify_viewer.state.inspection import Mark

EXAMPLES = (
    "examples: insonify view recording.xtf; insonify view wreck --recording recording.xtf; "
    "insonify view figure-4b --pair difference"
)
LIBRARIES = (
    "libegl1 libgl1 libglib2.0-0 libxkbcommon0 libdbus-1-3 libfontconfig1 "
    "libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0 libxkbcommon-x11-0"
)
APT = f"apt-get install {LIBRARIES}"
MOVIES, MOVIE_SIZE = (".webp", ".gif", ".mp4"), "880x480"
WINDOW_LIBRARIES = (
    "libxcb.so.1",
    "libxcb-cursor.so.0",
    "libxcb-icccm.so.4",
    "libxcb-keysyms.so.1",
    "libxcb-shape.so.0",
    "libxkbcommon-x11.so.0",
)


def register(subparsers: Any) -> None:
    """Add ``view`` to the sub-commands of ``insonify``."""
    parser = subparsers.add_parser(
        "view",
        description="Open the viewer on a scene, or on a recording beside the default scene.",
        epilog=EXAMPLES,
    )
    options.add_scene(parser, optional=True)
    parser.add_argument(
        "--recording", metavar="FILE", help=f"a record beside the scene: {RECORDS.describe(RECORDS.readable())}"
    )
    parser.add_argument(
        "--pair",
        nargs="?",
        const=Arrangement.WIPED.value,
        choices=[way.value for way in Arrangement],
        metavar="HOW",
        help="show the partner that the scene names as record A: "
        f"{', '.join(way.value for way in Arrangement)} (default: {Arrangement.WIPED.value})",
    )
    parser.add_argument("--snapshot", metavar="PNG", help="draw the window into this picture instead of opening it")
    parser.add_argument("--panel", metavar="NAME", help="open a panel, such as record, pixel or water")
    parser.add_argument(
        "--pin",
        nargs=3,
        metavar=("PING", "SIDE", "RANGE"),
        help="explain a pixel of the record from the start, e.g. --pin 150 starboard 36.5",
    )
    parser.add_argument(
        "--lesson",
        metavar="LESSON",
        help="begin a lesson in its own scene, by name or Markdown file (see 'insonify lesson')",
    )
    parser.set_defaults(run=run)
    movie = subparsers.add_parser(
        "movie",
        description="Draw the tow of a scene, the seabed in 3-D beside the record that grows ping by ping. It needs no "
        "screen. A .mp4 needs the package imageio-ffmpeg.",
        epilog="examples: insonify movie wreck -o tow.webp; insonify movie default -o tow.mp4 --size 1280x720",
    )
    options.add_scene(movie)
    options.add_output(movie, MOVIES)
    seconds = options.bounded(1.0, 600.0, "1 to 600 seconds")
    movie.add_argument("--seconds", type=seconds, default=10.0, metavar="S", help="duration (default: %(default)g)")
    movie.add_argument(
        "--size", type=_size, default=MOVIE_SIZE, metavar="WxH", help="pixels across and down (default: %(default)s)"
    )
    movie.set_defaults(run=run_movie)


def run(arguments: argparse.Namespace) -> int:
    """Open the viewer, or draw its window into a picture where it cannot be opened."""
    recording = _take_recording(arguments)
    lesson, scene = (None, options.chosen_scene(arguments)) if arguments.lesson is None else _chosen_lesson(arguments)
    if arguments.scene.lower().endswith(SUFFIX):  # an exercise hides what is to be found from its window
        scene, recording = edit(scene, {"targets": [], "volumes": []}), arguments.scene
    pin = None if arguments.pin is None else _pinned(scene, *arguments.pin)
    pair = _pairing(scene, arguments)
    reason = why_no_window()
    if arguments.snapshot is None and not reason:
        with compiled_elsewhere(first="insonify.display.example:compile_for_example"):
            # lazy: loads Qt, which no other command needs
            from insonify_viewer.application import open_window

            return open_window(scene, pin, lesson, recording, pair, _known_panel(arguments.panel))
    path = options.check_output(arguments.snapshot or options.free_name(options.FALLBACK), (".png",), "--snapshot")
    _leave_screen(reason)
    # lazy: loads Qt, which no other command needs
    from insonify_viewer.application import draw_window

    draw_window(scene, path, pin, lesson, recording, pair, _known_panel(arguments.panel))
    if arguments.snapshot is None:
        sys.stderr.write(f"insonify: no window can be opened ({reason}); it was drawn into {path}\n")
        return options.NO_WINDOW
    return 0


def run_movie(arguments: argparse.Namespace) -> None:
    """Draw the tow of a scene into a movie."""
    path, scene, (width, height) = options.chosen_output(arguments), options.chosen_scene(arguments), arguments.size
    _leave_screen(why_no_window())
    # lazy: loads Qt, which no other command needs
    from insonify_viewer.movie import check_room, draw_views, tow_views, write_movie

    views = tow_views(scene, arguments.seconds)
    check_room(path, len(views), arguments.size)
    drawn = options.tracked(draw_views(scene, arguments.size, views), len(views), lambda _: 1, "picture")
    write_movie(path, drawn)
    options.say(f"{path}: {len(views)} pictures of {width} x {height}")


def _leave_screen(reason: str) -> None:
    """Let Qt and VTK draw without a screen; a reason tells that there is none."""
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    if reason and sys.platform.startswith("linux"):
        # Without this, VTK tries the display first and prints an error.
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


def _size(text: str) -> tuple[int, int]:
    """Width and height of a movie, even numbers as video formats require."""
    found = re.fullmatch(r"([0-9]{3,4})x([0-9]{3,4})", text)
    width, height = map(int, found.groups()) if found else (0, 0)
    if not (760 <= width <= 3840 and 420 <= height <= 2160 and width % 2 == height % 2 == 0):
        raise argparse.ArgumentTypeError(f"{text}: give even numbers from 760x420 to 3840x2160, such as 1280x720")
    return width, height


def _chosen_lesson(arguments: argparse.Namespace) -> tuple[Lesson, Scene]:
    """Lesson to begin, checked, and its own scene."""
    from insonify.lessons.checks import check_lesson  # lazy: not every command needs lessons
    from insonify.lessons.lesson import load_lesson  # lazy: not every command needs lessons
    from insonify.lessons.states import states_of  # lazy: not every command needs lessons

    if arguments.scene != DEFAULT_SCENE or arguments.set or arguments.seed is not None:
        raise SceneError(f"--lesson {arguments.lesson}: opens a scene of its own; leave out SCENE, --set and --seed")
    lesson = load_lesson(arguments.lesson)
    check_lesson(lesson)
    return lesson, next(states_of(lesson))[1].scene


def _pairing(scene: Scene, arguments: argparse.Namespace) -> Arrangement | None:
    """Way in which a scene and its partner are shown from the start; None without ``--pair``."""
    if arguments.pair is None:
        return None
    if load_partner(scene) is None:
        raise SceneError("--pair: the scene names no partner; give it one, such as partner = ['water.surface=none']")
    return Arrangement(arguments.pair)


def _known_panel(name: str | None) -> str:
    """Return the name of a panel that is opened from the start; empty for none."""
    # lazy: loads Qt, which no other command needs
    from insonify_viewer.panels import find_panels

    known = sorted(panel.name for panel in find_panels()) if name else []
    if name and name not in known:
        raise SceneError(f"--panel {name}: is not a panel; choose one of {', '.join(known)}")
    return name or ""


def _pinned(scene: Scene, ping: str, side: str, slant_range: str) -> Mark:
    """Mark of a pixel that is pinned from the start."""
    from insonify_viewer.state.inspection import Mark  # lazy: only the window needs it

    try:
        number, distance = int(ping), float(slant_range)
    except ValueError as error:
        given = f"{ping} {side} {slant_range}"
        raise SceneError(f"--pin {given}: write a ping, a side and a range, such as 150 starboard 36.5") from error
    return Mark(*options.find_pixel(scene, number, side, distance))


def _take_recording(arguments: argparse.Namespace) -> str:
    """Return the file of a record that is named, in place of the scene or beside it; empty if none is."""
    if options.is_record(arguments.scene) and arguments.recording is None:
        arguments.scene, arguments.recording = DEFAULT_SCENE, arguments.scene
    name = arguments.recording or ""
    if name and not options.is_record(name):
        known = RECORDS.describe(RECORDS.readable())
        raise RECORDS.refusal(name, "does not have the suffix of a record", f"give {known}")
    if name and not Path(name).exists():
        raise RECORDS.refusal(name, "does not exist", "give the path of a record")
    return name


def why_no_window() -> str:
    """Return the reason why no window can be opened, as a clause; empty if one can."""
    if os.environ.get("QT_QPA_PLATFORM", "").startswith(("offscreen", "minimal")):
        return "QT_QPA_PLATFORM selects a platform without windows"
    if not sys.platform.startswith("linux") or os.environ.get("WAYLAND_DISPLAY"):
        return ""
    if not os.environ.get("DISPLAY"):
        return "there is no display"
    missing = [name for name in WINDOW_LIBRARIES if _library(name) is None]
    if missing:
        return f"the system lacks {missing[0]}; install it with: {APT}"
    return "" if _answers() else f"display {os.environ['DISPLAY']} does not answer"


def _library(name: str) -> ctypes.CDLL | None:
    try:
        return ctypes.CDLL(name)
    except OSError:
        return None


def _answers() -> bool:
    """Whether the X server of this environment accepts a connection."""
    xcb = ctypes.CDLL(WINDOW_LIBRARIES[0])
    xcb.xcb_connect.restype = ctypes.c_void_p
    connection = ctypes.c_void_p(xcb.xcb_connect(None, None))
    failed = xcb.xcb_connection_has_error(connection)
    xcb.xcb_disconnect(connection)
    return not failed
