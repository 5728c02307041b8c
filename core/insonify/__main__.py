"""The process of ``insonify`` and ``python -m insonify``, about the command itself."""

import gc
import io
import os
import sys
from collections.abc import Callable


def load() -> Callable[[], int]:
    """Load the command, and return what runs it."""
    # Modules stay until the process ends: to look for garbage among them, now and at the end, took a third of the time
    # to the end of a first ping.
    gc.disable()
    from insonify.cli import main as command

    gc.freeze()
    gc.enable()
    return command


def main() -> int:
    """Load the command and run it; returns its exit code."""
    _settle_output()
    try:
        command = load()
    except KeyboardInterrupt:
        sys.stderr.write("insonify: interrupted; no file was touched\n")
        return 130
    try:
        return command()
    finally:
        gc.freeze()


def _settle_output() -> None:
    """Let every character be written, escaped where an encoding lacks it; what a closed output is told is lost."""
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115  # open as long as the process is
    elif isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


if __name__ == "__main__":
    sys.exit(main())
