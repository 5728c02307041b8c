"""The process of ``insonify`` and ``python -m insonify``, about the command itself."""

import gc
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
    command = load()
    try:
        return command()
    finally:
        gc.freeze()


if __name__ == "__main__":
    sys.exit(main())
