"""Write a file, or a folder that counts as one, whole or not at all; remove what an ended process left unfinished.

A lease, which its process renews, tells what is being written from what was left.
"""

import errno
import os
import platform
import re
import secrets
import shutil
import signal
import stat
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import NamedTuple, NoReturn

from insonify.errors import FileWarning, SceneError, warn_caller
from insonify.io.file_access import FileFault, open_regular
from insonify.io.object_store import in_store, uploading
from insonify.operating_system import interrupt_main_thread, lock_file

UNFINISHED = "unfinished"  # in the name of the folder of incomplete files
NEW, FORMER = "new", "former"  # stems of the content there, and of a folder while it is being replaced
LONGEST_NAME = 255  # bytes
MOST_LINKS = 40  # from one to the next, as on Linux
# Sent by schedulers when time is up, by a terminal that is closed, by Ctrl-\, and by Ctrl-Break on Windows.
REQUESTS = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGBREAK") if hasattr(signal, name)]
# Errors that say what is wrong. HDF5 gives none for anything, and permissions for a file that it cannot begin.
NAMED = errno.errorcode.keys() - {errno.EIO, errno.EACCES}
PROBE = 2**16  # bytes that a disk which is not full takes
AGAIN = 1.0  # s after which a request to end is repeated: a bare `except` in a library may swallow the exit
LEASE = "lease"  # of the file in the folder
BEAT = 20.0  # s between renewals
SILENT = 600.0  # s without a renewal after which the owner has ended: kernels compile for a part of that
PATIENCE, PAUSE = 1.0, 0.01  # s to lock the file, and between tries: a process that looks locks it for a moment
UNLOCKED = "unlocked"


class Lease:
    """Lease of this process on a new folder, until it is released.

    The owner holds a lock on a file in the folder, which the system releases when the process ends, and renews the time
    of that file. A lock is proof among the processes of one kernel, which containers of a machine share. Elsewhere, or
    where a disk has no locks, a folder is given up when the file's time is old. Numbers of processes prove nothing: two
    containers with one disk have the same ones.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / LEASE
        self._file = open(self._path, "xb")  # noqa: SIM115  # open, and locked, as long as the lease
        deadline = time.monotonic() + PATIENCE
        while (locked := lock_file(self._file, exclusive=True)) is False and time.monotonic() < deadline:
            time.sleep(PAUSE)
        # Written after it is locked: an empty file proves nothing.
        self._file.write((kernel() if locked else UNLOCKED).encode())
        self._file.flush()
        self._released = threading.Event()
        with suppress(RuntimeError):  # no thread starts while the interpreter ends
            threading.Thread(target=self._renew, daemon=True).start()

    def _renew(self) -> None:
        while not self._released.wait(BEAT):
            with suppress(OSError):
                os.utime(self._path)

    def release(self) -> None:
        """End the lease; the folder may be removed by anybody then."""
        self._released.set()
        self._file.close()


def is_leased(folder: Path) -> bool:
    """Whether the owner of a folder, or of a file that an earlier version left, may still be at work."""
    path = folder / LEASE
    try:
        with open_regular(path) as file:  # anybody may have put a pipe there
            free = lock_file(file, exclusive=False)
            owner = file.read(len(kernel()) + 1).decode(errors="replace")
    except (OSError, FileFault):
        free, owner, path = None, "", folder
    if free is False:
        return True
    if free and owner == kernel():
        return False
    try:
        return _now(folder.parent) - path.stat().st_mtime < SILENT
    except FileNotFoundError:
        return False


@cache
def kernel() -> str:
    """Name the running kernel, which the containers of a machine share, or the machine where it has no name."""
    with suppress(OSError):
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    return platform.node()


def _now(folder: Path) -> float:
    """Return the time, in seconds, by the clock that dates the files of a folder: the clock of a server may differ."""
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            return os.fstat(file.fileno()).st_mtime
    except OSError:
        return time.time()


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path for the new content of a file; when it is complete, it replaces the file."""
    # After an error, an interrupt or a request to end, the old file is unchanged and no temporary file is left. What a
    # killed process left is removed by the next one that writes the same file.
    if not isinstance(path, str) and in_store(path):
        with uploading(path) as beside:
            yield beside
        return
    final = folder = Path(path)
    try:
        final = _follow_links(final)
        with unfinished_folder(final) as folder, terminated_cleanly(), _full_disk_named(final.parent):
            beside = folder / f"{NEW}{final.suffix}"
            yield beside
            _put(beside, final)
    except OSError as error:
        # The error names the final path, not the temporary one.
        raise type(error)(error.errno, error.strerror or str(error), str(path)) from error
    except UnicodeEncodeError as error:
        if not error.object.startswith(str(folder)):
            raise
        # HDF5 and GDAL take paths as UTF-8, whatever the bytes of a name on disk.
        raise OSError(errno.EILSEQ, "this format needs a path in UTF-8", str(path)) from error


def _follow_links(path: Path) -> Path:
    """Return what a link leads to, so that this is replaced, not the link; raise OSError for a link of a stranger."""
    # As Linux does it unless that is switched off: where everybody may put a link, one counts if it belongs to this
    # user or to the owner of the folder. Another would choose which file of this user is replaced.
    for _ in range(MOST_LINKS):
        if not path.is_symlink():
            return path
        folder = path.parent.stat()
        if folder.st_mode & stat.S_IWOTH and path.lstat().st_uid not in (_user(), folder.st_uid):
            raise OSError(errno.EACCES, "is a link that another user has put into a shared folder")
        path = path.parent / os.readlink(path)
    raise OSError(errno.ELOOP, os.strerror(errno.ELOOP))


def write_text(path: str | Path, text: str) -> None:
    """Write a text file whole or not at all: UTF-8 and the same ends of lines on every system."""
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8", newline="")


@contextmanager
def unfinished_folder(final: Path) -> Iterator[Path]:
    """Yield a folder beside a file for what belongs to it and is not complete; remove it afterwards."""
    clear_leftovers(final)
    folder = temporary_path(final)
    folder.mkdir()
    try:
        lease = Lease(folder)
        try:
            yield folder
        finally:
            lease.release()
    finally:
        _remove(folder)


@contextmanager
def _full_disk_named(folder: Path) -> Iterator[None]:
    """Turn an error of a library that does not name its cause into the error of a full disk, if the disk is full."""
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
    """Put a finished file or folder in its place; a folder is swapped with the old one."""
    if not (beside.is_dir() and final.is_dir()):
        beside.replace(final)
        return
    old = _former(beside.parent, final)
    final.replace(old)
    try:
        beside.replace(final)
    except OSError:
        old.replace(final)
        raise


def _former(folder: Path, final: Path) -> Path:
    """Return where the old folder is while a new one takes its place."""
    return folder / f"{FORMER}{final.suffix}"


@contextmanager
def terminated_cleanly(patience: float = AGAIN) -> Iterator[None]:
    """Turn requests to end the process into an exit that runs the clean-up, where no other handler is set."""
    # A request is repeated after `patience` seconds, for a library may swallow the exit.
    is_main = threading.current_thread() is threading.main_thread()
    caught = [number for number in REQUESTS if is_main and signal.getsignal(number) is signal.SIG_DFL]
    reminders: list[threading.Timer] = []

    def leave(number: int, frame: object) -> NoReturn:
        reminders.append(threading.Timer(patience, interrupt_main_thread, (number,)))
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


class Leftover(NamedTuple):
    """What a process of some machine left beside the file that it belongs to."""

    path: Path
    host: str
    process: int


def temporary_path(final: Path) -> Path:
    """Return a path beside a file for what is not complete, such as ``.record.unfinished-host-123-4567.nc``."""
    # The number is random: processes of two containers may be named and numbered alike.
    end = f".{UNFINISHED}-{_host()}-{os.getpid()}-{secrets.randbelow(10**9)}{final.suffix}"
    stem = final.stem
    while stem and len(os.fsencode(f".{stem}{end}")) > LONGEST_NAME:
        stem = stem[:-1]
    return final.with_name(f".{stem}{end}")


def clear_leftovers(final: Path) -> None:
    """Remove what ended processes of this user left beside a file; warn of what others write or left."""
    # A folder that was being replaced when its writer was killed is put back.
    for left in _leftovers(final.parent, re.escape(final.suffix)):
        # A long name was cut.
        stem = left.path.name[1:].rpartition(f".{UNFINISHED}-")[0]
        cut = len(os.fsencode(left.path.name)) > LONGEST_NAME - 4
        if not (stem == final.stem or (cut and final.stem.startswith(stem))):
            continue
        if is_leased(left.path):
            other = f"process {left.process}" + f" of {left.host}" * (left.host != _host())
            text = f"{final}: {other} is writing it as well; the last to finish replaces the other"
            warn_caller(FileWarning(text))
        elif not _is_own(left.path):
            text = f"{final}: {left.path.name} beside it was left by another user; remove it if it is stale"
            warn_caller(FileWarning(text))
        else:
            if not final.exists() and _former(left.path, final).exists():
                _former(left.path, final).rename(final)
            _remove(left.path)


def clear_ended(folder: Path) -> None:
    """Remove all that ended processes of this user left incomplete in a folder."""
    for left in _leftovers(folder, ".*"):
        if _is_own(left.path) and not is_leased(left.path):
            _remove(left.path)


def _leftovers(folder: Path, end: str) -> list[Leftover]:
    """Find what is incomplete in a folder, by the end of its name as a pattern."""
    pattern = re.compile(rf"\..*\.{UNFINISHED}-(\w+)-(\d+)-\d+{end}", re.DOTALL)
    found = ((name, pattern.fullmatch(name)) for name in os.listdir(folder))
    return [Leftover(folder / name, match[1], int(match[2])) for name, match in found if match]


def _remove(path: Path) -> None:
    """Remove a file or a folder, which another process may be removing as well."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _host() -> str:
    return re.sub(r"\W", "_", platform.node(), flags=re.ASCII)[:32] or "unknown"


def _user() -> int:
    return os.getuid() if hasattr(os, "getuid") else 0  # which is everybody's number on Windows


def _is_own(path: Path) -> bool:
    try:
        return path.lstat().st_uid == _user()
    except FileNotFoundError:  # removed meanwhile
        return True
