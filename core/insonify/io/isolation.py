"""Readers run in a process of their own, which may be killed: limits of time and memory, and no harm from a crash.

GDAL, netCDF and trimesh read formats of great complexity. A damaged file can make them crash, loop, allocate without
bound, or write to the terminal past Python.
"""

from __future__ import annotations

import atexit
import json
import os
import pickle
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any, TypeVar, cast

from insonify.errors import SceneError
from insonify.io.file_access import FileFault, largest_expansion, stored_bytes

Result = TypeVar("Result")
LONGEST = (
    15.0  # s to read a small file, the import of its library included; of processor time where the system tells it
)
STARVED = 6.0  # times as long a file may take while other programs keep the processors busy
SLOWEST = 1e6  # bytes per second of a large one
COPIES = 3  # of the content, which readers hold at once
START = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from insonify.io import isolated; isolated.serve()"
PIPE = 2**20  # bytes of a pipe, where the system lets it be chosen
LENGTH = 8  # bytes of every length in an answer


def run_isolated(read: Callable[[str], Result], path: str) -> Result:
    """Call a reader in another process.

    The process is kept for later calls. To be called within `guarded`, one at a time.
    """
    path = os.path.abspath(path)
    if not sys.executable:  # Python is embedded in another program
        return read(path)
    memory = COPIES * largest_expansion(path)
    seconds = LONGEST + stored_bytes(path) / SLOWEST
    request = json.dumps([read.__module__, read.__name__, path, memory, seconds]).encode() + b"\n"
    kind, value = _exchange(request, seconds)
    if kind == "refused":
        raise SceneError(value)
    if kind == "fault":
        raise FileFault(*value)
    if kind == "failed":
        raise RuntimeError(value)
    return cast("Result", value)


class _Process:
    """The other process and its pipes."""

    def __init__(self) -> None:
        self.owner = os.getpid()
        self.process = subprocess.Popen(
            [sys.executable, "-c", START, json.dumps(sys.path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            pipesize=PIPE,
        )

    def ask(self, request: bytes, seconds: float) -> Any:
        """Send a request and return the answer; kills the process after the time."""
        answered, late = threading.Event(), threading.Event()
        watch = threading.Thread(target=self._kill_after, args=(seconds, answered, late), daemon=True)
        watch.start()
        try:
            return self._answer(request)
        except (OSError, EOFError):
            if late.is_set():
                raise FileFault(f"takes longer than {seconds:.0f} s to read", "export it again") from None
            raise
        finally:
            answered.set()

    def _kill_after(self, seconds: float, answered: threading.Event, late: threading.Event) -> None:
        """Kill the process after a time, unless it has answered; while it waits for a processor, time stands still."""
        before, _ = _processor_time(self.process.pid)
        left, end = seconds, time.monotonic() + STARVED * seconds
        while not answered.wait(left):
            taken, runs = _processor_time(self.process.pid)
            left = min(seconds - (taken - before), end - time.monotonic()) if runs else 0.0
            if left <= 0.0:
                late.set()
                self.process.kill()
                return

    def _answer(self, request: bytes) -> Any:
        sent, received = cast("IO[bytes]", self.process.stdin), cast("IO[bytes]", self.process.stdout)
        sent.write(request)
        sent.flush()
        count = int.from_bytes(_exactly(received, LENGTH), "little")
        pieces = [_exactly(received, int.from_bytes(_exactly(received, LENGTH), "little")) for _ in range(count)]
        # Written by this package's own code in the other process.
        return pickle.loads(pieces[0], buffers=pieces[1:])

    def stop(self) -> None:
        if self.owner == os.getpid():  # not the process of a parent that has forked
            self.process.kill()
            self.process.communicate()

    def __del__(self) -> None:
        """End the process with the last reference to it, as when the package is imported anew."""
        if hasattr(self, "process"):
            self.stop()


def _processor_time(process: int) -> tuple[float, bool]:
    """Processor time of a process in seconds, and whether it runs or could; no time where the system does not say."""
    try:
        stat = Path(f"/proc/{process}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return 0.0, False
    state, *fields = stat.rpartition(")")[2].split()
    return (int(fields[10]) + int(fields[11])) / os.sysconf("SC_CLK_TCK"), state == "R"


_kept: _Process | None = None


def _exchange(request: bytes, seconds: float) -> Any:
    """Ask the process that is kept, or a new one."""
    global _kept
    if _kept is not None and (_kept.owner != os.getpid() or _kept.process.poll() is not None):
        stop()
    _kept = _kept or _Process()
    try:
        return _kept.ask(request, seconds)
    except (OSError, EOFError):
        stop()
        raise FileFault("cannot be read (the library that reads it fails)", "export it again") from None
    except BaseException:  # an answer that was not read to its end would be taken for the next one
        stop()
        raise


def stop() -> None:
    """End the process; a later call starts a new one."""
    global _kept
    if _kept is not None:
        _kept.stop()
        _kept = None


def _exactly(stream: IO[bytes], count: int) -> bytearray:
    content = bytearray(count)
    view, at = memoryview(content), 0
    while at < count:
        got = stream.readinto(view[at:])  # type: ignore[attr-defined]
        if not got:
            raise EOFError
        at += got
    return content


atexit.register(stop)
