"""The ``insonify`` command: finds the sub-commands, and turns every mistake into one sentence."""

import argparse
import difflib
import gc
import importlib.metadata
import os
import sys
import warnings
from collections.abc import Iterable, Sequence
from contextlib import redirect_stdout, suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn, TextIO

from insonify.commands import OF_VIEWER, OWN
from insonify.compiler.cache_folder import CacheWarning
from insonify.compiler.progress import watch_compilation
from insonify.errors import FileWarning, PlanWarning, SceneError, plain_text
from insonify.foreign_settings import MATPLOTLIB, ignore_settings
from insonify.plugins import announced, loaded, modules_in
from insonify.progress import CompilationBar

ignore_settings(MATPLOTLIB)
COMMANDS = "insonify.commands"  # a package, and a group of entry points
VIEWER = "insonify_viewer"
WRONG, INTERRUPTED = 2, 130
LONG = 1000  # characters of either end of a sentence
ABOUT = ("-h", "--help", "--version")
APT = (
    "sudo apt-get install -y libegl1 libgl1 libglib2.0-0 libxkbcommon0 libdbus-1-3 libfontconfig1 "
    "libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0 libxkbcommon-x11-0"
)


def main(words: Sequence[str] | None = None) -> int:
    """Run the command."""
    try:
        with warnings.catch_warnings(), watch_compilation(CompilationBar()), redirect_stdout(_PlainOutput(sys.stdout)):
            for category in (FileWarning, PlanWarning):
                warnings.simplefilter("always", category)
            warnings.showwarning = _warn
            code = _run(list(sys.argv[1:] if words is None else words))
        sys.stdout.flush()
        return code
    except SceneError as error:
        return _complain(str(error))
    except BrokenPipeError:
        # The reader has closed the pipe. The flush of the interpreter at exit must not fail on it again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        return _complain(
            f"{error.filename or 'output'}: {error.strerror or error}; check the path, its permissions and the disk"
        )
    except MemoryError:
        return _complain(
            "the record does not fit in memory; write .nc, which is streamed, or reduce track.pings or sonar.bins"
        )
    except KeyboardInterrupt:
        sys.stderr.write("insonify: interrupted; no file was touched\n")
        return INTERRUPTED


class _PlainOutput:
    """Standard output without what a terminal would obey: titles and names come from files of others."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        return self._stream.write(plain_text(text))

    def writelines(self, lines: Iterable[str]) -> None:
        self._stream.writelines(map(plain_text, lines))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def _warn(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
    """Write what a file or a plan lacks as one sentence, and other warnings as Python does."""
    if issubclass(category, (FileWarning, PlanWarning, CacheWarning)):
        sys.stderr.write(f"insonify: {_plain_sentence(str(message))}\n")
    else:
        sys.stderr.write(warnings.formatwarning(message, category, *where[:2]))


def _plain_sentence(text: str) -> str:
    """Text on one line, as a terminal may show it; a long name or value within is cut, fault and remedy stay."""
    text = plain_text(" ".join(text.split()))
    return text if len(text) <= 2 * LONG else f"{text[:LONG]} … {text[-LONG:]}"


def _complain(sentence: str) -> int:
    with suppress(OSError):  # standard error on a full disk: the exit code remains
        sys.stderr.write(f"insonify: {_plain_sentence(sentence)}\n")
        sys.stderr.flush()
    return WRONG


def _run(words: list[str]) -> int:
    known = words and words[0] in (*OWN, *OF_VIEWER, *ABOUT)
    parser, commands = build_parser(words[0] if known else "view")
    arguments = parser.parse_args(_with_command(words, list(commands)))
    if not gc.isenabled():  # see `insonify.__main__`
        gc.freeze()
        gc.enable()
    try:
        return arguments.run(arguments) or 0
    except ImportError as error:
        if arguments.run.__module__.partition(".")[0] != VIEWER:
            raise
        return _without_viewer(error, arguments)


class _Parser(argparse.ArgumentParser):
    """Argument parser that reports a mistake in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        self.exit(WRONG, f"{self.prog}: {_plain_sentence(message)}; see '{self.prog} --help'\n")


def build_parser(command: str = "") -> tuple[argparse.ArgumentParser, dict[str, Any]]:
    """Build the parser. Commands of this project other than ``command``, if it is given, have a line of help alone."""
    asked = [command] if command else [*OWN, *OF_VIEWER]
    parser = _Parser(
        prog="insonify",
        description="Tow a side-scan sonar over a seabed of your own making and watch the record scroll.",
        epilog="'insonify [SCENE]' without a command opens the viewer.",
    )
    parser.add_argument("--version", action="version", version=f"insonify {importlib.metadata.version('insonify')}")
    subparsers = parser.add_subparsers(title="commands", metavar="COMMAND", dest="command", required=True)
    for name, line in OWN.items():
        if name in asked:
            import_module(f"{COMMANDS}.{name}").register(subparsers)
        else:
            subparsers.add_parser(name, help=line)
    for module in modules_in(COMMANDS, without=(*OWN, "options")):
        module.register(subparsers)
    missing = ImportError(f"No module named {VIEWER!r}")
    for entry in announced(COMMANDS):
        if _is_of_viewer(entry) and OF_VIEWER.keys().isdisjoint(asked):
            for name, line in OF_VIEWER.items():
                subparsers.add_parser(name, help=line)
            continue
        if not _is_of_viewer(entry):
            loaded([entry], lambda register: register(subparsers))
            continue
        try:
            entry.load()(subparsers)
        except ImportError as error:
            missing = error
    if "view" not in subparsers.choices:
        from insonify.commands.options import add_scene  # lazy: loads the models of the scene

        view = subparsers.add_parser("view", help="open the viewer (not installed)")
        add_scene(view, optional=True)
        view.set_defaults(run=partial(_without_viewer, missing))
    return parser, subparsers.choices


def _is_of_viewer(entry: importlib.metadata.EntryPoint) -> bool:
    return entry.value.partition(".")[0] == VIEWER


def _with_command(words: list[str], commands: list[str]) -> list[str]:
    """Put ``view`` before a scene given without a command; raise SceneError for a mistyped command."""
    first = words[0] if words else ""
    if first in commands or first in ABOUT:
        return words
    from insonify.scene import bundled_scenes  # lazy: the help of the command needs no scene

    is_scene = not first or first.startswith("-") or first in bundled_scenes() or Path(first).exists()
    close = difflib.get_close_matches(first, commands, n=1)
    if not is_scene and close:
        raise SceneError(f"{first!r} is neither a command nor a scene; did you mean 'insonify {close[0]}'?")
    if not is_scene and len(words) > 1 and not words[1].startswith("-"):  # of a scene alone `view` says what is wrong
        raise SceneError(f"{first!r} is neither a command nor a scene; 'insonify --help' lists the commands")
    return ["view", *words]


def _without_viewer(error: ImportError, arguments: argparse.Namespace) -> int:
    """Report what the viewer lacks; where only system libraries are missing, render the record instead."""
    if ".so" not in str(error):
        return _complain(f"the viewer is not installed ({error}); run: pip install 'insonify[viewer]'")
    # lazy: the help of the command needs no scene
    from insonify.commands.options import FALLBACK, NO_WINDOW, check_output, chosen_scene, free_name
    from insonify.commands.render import write
    from insonify.display.display_options import DisplayOptions

    path = check_output(getattr(arguments, "snapshot", None) or free_name(FALLBACK), (".png",))
    write(chosen_scene(arguments), path, DisplayOptions())
    _complain(f"the viewer lacks system libraries ({error}); the record was written to {path} instead; run: {APT}")
    return NO_WINDOW
