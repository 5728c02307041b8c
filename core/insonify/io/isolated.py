"""The process that `insonify.io.isolation` starts: reads files on request, within a limit of memory."""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import signal
import sys
import threading
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import IO, Any

from insonify.errors import SceneError
from insonify.io.file_access import FileFault, reason
from insonify.io.isolation import LENGTH, STARVED

GRACE = 5.0  # s beyond the greatest limit of a request, in which the process that asked ends this one if it still runs
IDLE = 60.0  # s without a request after which the process ends
# GDAL reads companions of a file in any format that it knows: none that names other files, asks a server or runs code.
SKIPPED = (
    "VRT DERIVED GTI STACTA STACIT WMS WCS WMTS HTTP OGCAPI DAAS EEDA EEDAI PLMOSAIC NGW RDA JPIPKAK CAD WFS OAPIF "
    "Rasterlite GeoRaster PostGISRaster TileDB Zarr SENTINEL2 S102 S104 S111 PDF netCDF HDF4 HDF4Image"
)
SETTINGS = {"GDAL_SKIP": SKIPPED, "GDAL_VRT_ENABLE_PYTHON": "NO", "GDAL_DRIVER_PATH": "disable"}
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def serve() -> None:
    """Answer requests until standard input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # an interrupt reaches the process that waits, which ends this one
    os.environ.update(SETTINGS)
    os.environ.update(dict.fromkeys(THREADS, "1"))
    with os.fdopen(os.dup(1), "wb") as answers:
        os.dup2(2, 1)  # libraries may print
        while (request := _next_request()) is not None:
            _send(answers, _answer(*request))


def _next_request() -> list[Any] | None:
    timer = threading.Timer(IDLE, os._exit, (0,))
    timer.daemon = True
    timer.start()
    line = sys.stdin.buffer.readline()
    timer.cancel()
    return list(json.loads(line)) if line else None


def _answer(module: str, name: str, path: str, memory: int, seconds: float) -> tuple[str, Any]:
    """Call a reader; return the kind of its outcome and the outcome."""
    try:
        read = getattr(import_module(module), name)
        with _limited(memory), _ended_after(STARVED * seconds + GRACE):
            return "read", read(path)
    except SceneError as error:
        return "refused", str(error)
    except FileFault as error:
        return "fault", (error.fault, error.remedy)
    except Exception as error:  # every library fails in ways of its own
        return "failed", reason(error)


def _send(answers: IO[bytes], answer: tuple[str, Any]) -> None:
    """Write an answer as lengths and pieces; arrays are sent without a copy."""
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(answer, protocol=5, buffer_callback=buffers.append)
    pieces = [memoryview(head), *(buffer.raw() for buffer in buffers)]
    answers.write(len(pieces).to_bytes(LENGTH, "little"))
    for piece in pieces:
        answers.write(piece.nbytes.to_bytes(LENGTH, "little"))
        answers.write(piece)
    answers.flush()


@contextlib.contextmanager
def _ended_after(seconds: float) -> Iterator[None]:
    """Let the system end this process if a block takes longer, where it can; also a loop that is not in Python."""
    if not hasattr(signal, "setitimer"):
        yield
        return
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


@contextlib.contextmanager
def _limited(memory: int) -> Iterator[None]:
    """Let allocations fail that exceed what the process holds by more than the given bytes, where the system can."""
    held = _private_bytes()
    if held is None:
        yield
        return
    # lazy: not on every system
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    most = held + memory
    resource.setrlimit(resource.RLIMIT_DATA, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def _private_bytes() -> int | None:
    """Bytes that count towards RLIMIT_DATA; None where the system does not say."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return None
    return int(status.partition("VmData:")[2].split()[0]) * 1024
