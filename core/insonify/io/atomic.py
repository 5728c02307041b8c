"""Write a file, or a folder that counts as one, whole or not at all."""

from __future__ import annotations

import errno
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn, cast

from insonify.errors import SceneError
from insonify.io.unfinished import FORMER, clear_leftovers, remove, temporary_path

# Sent by schedulers when time is up, by a terminal that is closed, and by Ctrl-\.
REQUESTS = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)]
NAMED = errno.errorcode.keys() - {errno.EIO}  # errors that say what is wrong; HDF5 gives none for anything
PROBE = 2**16  # bytes that a disk which is not full takes
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
            with _terminated_cleanly(), _full_disk_named(final.parent):
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


@contextmanager
def _full_disk_named(folder: Path) -> Iterator[None]:
    """Turn an error of a library that does not name its cause into that of a full disk, if the disk is full."""
    try:
        yield
    except SceneError:
        raise
    except Exception as error:
        if getattr(error, "errno", None) in NAMED:
            raise
        try:
            with tempfile.TemporaryFile(dir=folder) as file:
                file.write(bytes(PROBE))
        except OSError as cause:
            raise cause from error
        raise


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
    """Turn requests to end the process into an exit that runs the clean-up, where nobody else handles them."""
    is_main = threading.current_thread() is threading.main_thread()
    caught = [number for number in REQUESTS if is_main and signal.getsignal(number) is signal.SIG_DFL]
    reminders: list[threading.Timer] = []

    def leave(number: int, frame: object) -> NoReturn:
        del frame
        # A library may have a bare `except` where the exit is raised, and go on: it is raised again.
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
