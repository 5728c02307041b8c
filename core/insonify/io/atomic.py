"""Write a file, or a folder that counts as one, whole or not at all; remove what an ended process left unfinished."""

from __future__ import annotations

import errno
import itertools
import os
import platform
import re
import shutil
import signal
import sys
import tempfile
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple, NoReturn, cast

from insonify.errors import FileWarning, SceneError

UNFINISHED, FORMER = "unfinished", "former"  # an incomplete file, and a folder while it is being replaced
LONGEST_NAME = 255  # bytes
_numbers = itertools.count()
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


def write_text(path: str | Path, text: str) -> None:
    """Write a text file whole or not at all: UTF-8 and the same ends of lines on every system."""
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8", newline="")


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


class Leftover(NamedTuple):
    """A file or folder beside the one that it belongs to, made by a process of some machine."""

    path: Path
    kind: str
    host: str
    process: int


def temporary_path(final: Path, kind: str = UNFINISHED) -> Path:
    """Return a path beside a file for its new or its former content, such as ``.record.unfinished-host-123-0.nc``."""
    end = f".{kind}-{_host()}-{os.getpid()}-{next(_numbers)}{final.suffix}"
    stem = final.stem
    while stem and len(os.fsencode(f".{stem}{end}")) > LONGEST_NAME:
        stem = stem[:-1]
    return final.with_name(f".{stem}{end}")


def clear_leftovers(final: Path) -> None:
    """Remove files that ended processes of this user and machine left beside a file; warn of files in use elsewhere.

    A folder that was being replaced when its writer was killed is put back.
    """
    for left in list(_leftovers(final)):
        if left.host != _host() or not _is_own(left.path):
            text = f"{final}: {left.path.name} beside it was left by another user or machine; remove it if it is stale"
            warnings.warn(FileWarning(text), stacklevel=4)
        elif _is_running(left.process):
            if left.kind == UNFINISHED:
                text = f"{final}: process {left.process} is writing it as well; the last to finish replaces the other"
                warnings.warn(FileWarning(text), stacklevel=4)
        elif left.kind == FORMER and not final.exists():
            left.path.rename(final)
        else:
            remove(left.path)


def clear_ended(folder: Path) -> None:
    """Remove all unfinished files that ended processes of this user and machine left in a folder."""
    pattern = re.compile(rf"\..*\.{UNFINISHED}-(\w+)-(\d+)-\d+(\.\w+)?")
    for name in os.listdir(folder):
        match = pattern.fullmatch(name)
        path = folder / name
        if match and match[1] == _host() and _is_own(path) and not _is_running(int(match[2])):
            remove(path)


def remove(path: Path) -> None:
    """Remove a file or a folder, if there is one."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _leftovers(final: Path) -> Iterator[Leftover]:
    pattern = re.compile(rf"\.(.*)\.({UNFINISHED}|{FORMER})-(\w+)-(\d+)-\d+{re.escape(final.suffix)}")
    for name in os.listdir(final.parent):
        match = pattern.fullmatch(name)
        # A long name was cut.
        if match and (match[1] == final.stem or (len(os.fsencode(name)) > LONGEST_NAME - 4 and match[1] in final.stem)):
            yield Leftover(final.parent / name, match[2], match[3], int(match[4]))


def _host() -> str:
    return re.sub(r"\W", "_", platform.node(), flags=re.ASCII)[:32] or "unknown"


def _is_own(path: Path) -> bool:
    return not hasattr(os, "getuid") or path.lstat().st_uid == os.getuid()


def _is_running(process: int) -> bool:
    """Whether a process of this machine runs; true where the system cannot answer without ending it."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
