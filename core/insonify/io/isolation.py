"""Readers run in a process of their own, which may be killed: limits of time and memory, and no harm from a crash.

GDAL and netCDF read formats of great complexity, and meshes may be huge. A damaged file can make a reader crash, loop,
allocate without bound, or write to the terminal past Python.
"""

import atexit
import os
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeVar, cast

from insonify.child_process import STARVED, ChildProcess, serve
from insonify.errors import SceneError
from insonify.io.file_access import FileFault, largest_expansion, reason, stored_bytes
from insonify.operating_system import ended_after, limited_memory

Result = TypeVar("Result")
# s to read a small file, the import of its library included; of processor time where the system measures it
LONGEST = 15.0
SLOWEST = 1e6  # bytes per second of a large one
COPIES = 3  # of the content, which readers have in memory at once
GRACE = 5.0  # s beyond the greatest time, in which the parent ends the process if both still run
IDLE = 60.0  # s without a request after which the process ends
# GDAL also reads files beside a raster, in any format. These formats may name other files, call a server or run code.
SKIPPED = (
    "VRT DERIVED GTI STACTA STACIT WMS WCS WMTS HTTP OGCAPI DAAS EEDA EEDAI PLMOSAIC NGW RDA JPIPKAK CAD WFS OAPIF "
    "Rasterlite GeoRaster PostGISRaster TileDB Zarr SENTINEL2 S104 S111 PDF netCDF HDF4 HDF4Image"
)
SETTINGS = {"GDAL_SKIP": SKIPPED, "GDAL_VRT_ENABLE_PYTHON": "NO", "GDAL_DRIVER_PATH": "disable"} | dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"
)
_child: ChildProcess | None = None


def run_isolated(read: Callable[[str], Result], path: str) -> Result:
    """Call a reader in another process."""
    # The process is kept for later calls. To be called within `guarded`, one at a time.
    path = os.path.abspath(path)
    if not sys.executable:  # Python is embedded in another program
        return read(path)
    seconds = LONGEST + stored_bytes(path) / SLOWEST
    answer = _exchange((read.__module__, read.__name__, path, COPIES * largest_expansion(path), seconds), seconds)
    if isinstance(answer, Exception):
        raise answer
    return cast("Result", answer)


def _exchange(request: tuple[Any, ...], seconds: float) -> Any:
    """Send a request to the process that is kept, or to a new one, and return its answer."""
    global _child
    if _child is not None and not _child.is_usable():
        stop()
    is_new = _child is None
    _child = _child or ChildProcess(__name__, **SETTINGS)
    try:
        _child.send(request)
        return _child.receive_within(seconds)
    except TimeoutError:
        stop()
        raise FileFault(f"takes longer than {seconds:.0f} s to read", "export it again") from None
    except (OSError, EOFError):
        stop()
        if not is_new:  # it may have ended for want of work as the request was sent
            return _exchange(request, seconds)
        raise FileFault("cannot be read (the library that reads it fails)", "export it again") from None
    except BaseException:  # an answer that was not read to its end would be taken for the next one
        stop()
        raise


def stop() -> None:
    """End the process; a later call starts a new one."""
    global _child
    if _child is not None:
        _child.stop()
        _child = None


atexit.register(stop)


def main() -> None:
    """Read files in the child process, one for each request."""
    serve(lambda request, send: send(_read(*request)), IDLE)


def _read(module: str, name: str, path: str, memory: int, seconds: float) -> Any:
    """Call a reader within its limits; return its result, or an error for the parent process to raise."""
    try:
        read = getattr(import_module(module), name)
        with limited_memory(memory), ended_after(STARVED * seconds + GRACE):
            return read(path)
    except (SceneError, FileFault) as error:
        return error
    except Exception as error:  # libraries raise errors of many types
        return RuntimeError(reason(error))
