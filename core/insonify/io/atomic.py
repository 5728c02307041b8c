"""Write a file, or a folder that counts as one, whole or not at all."""

from __future__ import annotations

import errno
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn, cast

from insonify.io.unfinished import FORMER, clear_leftovers, remove, temporary_path

# Sent by schedulers when time is up, by a terminal that is closed, and by Ctrl-\.
REQUESTS = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)]
AGAIN = 1.0  # s after which a request to end is repeated


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path beside the final one; the finished file replaces the final one.

    After an error, an interrupt or a request to end, the old file is unchanged and no temporary file is left. What a
    killed process left is removed by the next one that writes the same file.
    """
    final = Path(path)
    # A link is followed, so that the file it points to is replaced, not the link.
    final = final.resolve() if final.is_symlink() else final
    try:
        clear_leftovers(final)
        beside = temporary_path(final)
        try:
            with _terminated_cleanly():
                yield beside
                _put(beside, final)
        finally:
            remove(beside)
    except OSError as error:
        # The error names the final path, not the temporary one.
        raise type(error)(error.errno, error.strerror or str(error), str(path)) from error
    except UnicodeEncodeError as error:
        if error.object != str(beside):
            raise
        # HDF5 and GDAL take paths as UTF-8, whatever the bytes of a name on disk.
        raise OSError(errno.EILSEQ, "this format needs a path in UTF-8", str(path)) from error


def _put(beside: Path, final: Path) -> None:
    """Put a finished file or folder in its place; a folder is swapped with the old one, which is then removed."""
    if not (beside.is_dir() and final.is_dir()):
        beside.replace(final)
        return
    old = temporary_path(final, FORMER)
    final.replace(old)
    try:
        beside.replace(final)
    except OSError:
        old.replace(final)
        raise
    remove(old)


@contextmanager
def _terminated_cleanly() -> Iterator[None]:
    """Turn requests to end the process into an exit that runs the clean-up, where no other handler is set."""
    is_main = threading.current_thread() is threading.main_thread()
    caught = [number for number in REQUESTS if is_main and signal.getsignal(number) is signal.SIG_DFL]
    reminders: list[threading.Timer] = []

    def leave(number: int, frame: object) -> NoReturn:
        del frame
        # A bare `except` in a library may swallow the exit, so it is raised again.
        reminders.append(threading.Timer(AGAIN, _interrupt_main_thread, (number,)))
        reminders[-1].daemon = True
        reminders[-1].start()
        sys.exit(128 + number)

    for number in caught:
        signal.signal(number, leave)
    try:
        yield
    finally:
        for reminder in reminders:
            reminder.cancel()
        for number in caught:
            signal.signal(number, signal.SIG_DFL)


def _interrupt_main_thread(number: int) -> None:
    """Send a signal so that the main thread wakes where it waits, where the system can."""
    if sys.platform == "win32":
        signal.raise_signal(number)
    else:
        signal.pthread_kill(cast("int", threading.main_thread().ident), number)
