"""Entry point of ``insonify`` and ``python -m insonify``: output encoding, garbage collection, exit code."""

import atexit
import gc
import io
import os
import sys
import threading
from collections.abc import Callable
from typing import NoReturn

ENDED = 128  # exit codes above it say that a signal ended the command
SELDOM = 100_000  # objects after which garbage is collected; blocks of records leave no cycles behind
# Saves 40 ms: pydantic looks for no plugins, and idle threads of OpenBLAS sleep at once.
QUICK = {"PYDANTIC_DISABLE_PLUGINS": "1", "OPENBLAS_THREAD_TIMEOUT": "4"}


def load() -> Callable[[], int]:
    """Load what finds the command, and return what loads and runs it."""
    # Modules stay until the process ends. Collecting garbage among them takes a third of the time to a first ping.
    gc.disable()  # until the command is loaded
    gc.set_threshold(SELDOM)  # the command loads more
    for name, value in QUICK.items():
        os.environ.setdefault(name, value)
    from insonify.cli import main as command  # lazy: garbage is not collected meanwhile

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


def run() -> NoReturn:
    """Run the command and end the process."""
    try:
        code = main()
    except SystemExit as leaving:
        if not (isinstance(leaving.code, int) and leaving.code > ENDED):
            raise
        code = leaving.code
    end(code)


def end(code: int) -> NoReturn:
    """End the process: at once after an interrupt, or while a thread is at work."""
    # A thread that compiles or traces cannot be interrupted. The interpreter would wait for some; others it would leave
    # at work while the libraries below them are taken down, which ends the process by a signal.
    if code > ENDED or any(thread.daemon for thread in threading.enumerate()):
        atexit._run_exitfuncs()  # ends the processes that read files; threads would be waited for after it
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    sys.exit(code)


def _settle_output() -> None:
    """Escape characters that the encoding of standard output lacks; discard what is written to a closed stream."""
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8", newline="")  # noqa: SIM115  # open as long as the process is
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8", newline="")  # noqa: SIM115  # open as long as the process is
    elif isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


if __name__ == "__main__":
    run()
