"""Lease on a folder of unfinished files: a process, in whichever container or machine, that may still write there.

The owner holds a lock on a file in the folder, which the system releases when the process ends, and renews the time of
that file. A lock is proof among the processes of one kernel, which containers of a machine share. Elsewhere, or where a
disk has no locks, a folder is given up when the file's time is old. Numbers of processes prove nothing: two containers
with one disk have the same ones.
"""

import os
import platform
import sys
import tempfile
import threading
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import BinaryIO

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

NAME = "lease"  # of the file in the folder
BEAT = 20.0  # s between renewals
SILENT = 600.0  # s without a renewal after which the owner has ended: kernels compile for a part of that
PATIENCE, PAUSE = 1.0, 0.01  # s to lock the file, and between tries: a process that looks locks it for a moment
UNLOCKED = "unlocked"
FAR = 2**30  # byte that is locked where locks concern bytes, which could otherwise not be read


class Lease:
    """Lease of this process on a new folder, until it is released."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / NAME
        self._file = open(self._path, "xb")  # noqa: SIM115  # open, and locked, as long as the lease
        deadline = time.monotonic() + PATIENCE
        while (locked := _lock(self._file, exclusive=True)) is False and time.monotonic() < deadline:
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
    path = folder / NAME
    try:
        with open(path, "rb") as file:
            free = _lock(file, exclusive=False)
            told = file.read(len(kernel()) + 1).decode(errors="replace")
    except OSError:
        free, told, path = None, "", folder
    if free is False:
        return True
    if free and told == kernel():
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
    """Time by the clock of the machine whose disk a folder is on."""
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            return os.fstat(file.fileno()).st_mtime
    except OSError:
        return time.time()


def _lock(file: BinaryIO, exclusive: bool) -> bool | None:
    """Lock a file until it is closed: whether it is locked now, or None where the disk has no locks."""
    try:
        if sys.platform == "win32":
            file.seek(FAR)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            file.seek(0)
        else:
            fcntl.flock(file, (fcntl.LOCK_EX if exclusive else fcntl.LOCK_SH) | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        return None
    return True
