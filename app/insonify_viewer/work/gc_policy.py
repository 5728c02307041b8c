"""Garbage collection on the main thread alone, and what becomes of freed memory.

Widgets refer to one another in cycles. Python collects cycles on whichever thread allocates next. On a worker thread
that would destroy widgets and their OpenGL contexts while the main thread draws, which stalls or ends the program.
"""

from __future__ import annotations

import ctypes
import gc
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from insonify.array_cache import ARRAYS

OLDEST = 2  # generation
SHARE = 0.005  # of the time that collections of the oldest generation may take

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX = -1, -3, -8  # as in malloc.h of the GNU C library
LARGE = 2**20  # bytes; larger arrays are returned to the system as soon as they are freed
STORES = 4
OF_ANOTHER = AttributeError, OSError, TypeError  # C library, which lacks the functions

_left_out = threading.Event()  # libraries, since collection by hand began; to count frozen objects takes 0.3 s


@contextmanager
def collected_by_hand() -> Iterator[GcPolicy]:
    """Turn automatic collection off until the block ends, and collect everything then."""
    # Objects that exist before are frozen meanwhile: they are mostly those of libraries, which take long to traverse.
    gc.disable()
    gc.freeze()
    _left_out.clear()
    try:
        yield GcPolicy()
    finally:
        if _left_out.is_set():
            gc.unfreeze()  # widgets were left out with the libraries that were loaded meanwhile
        gc.collect()
        gc.unfreeze()
        gc.enable()


def leave_out_libraries() -> None:
    """Leave everything that exists out of later collections; to be called once libraries are loaded."""
    # Their objects are most of all that there are: a collection that goes through them holds the main thread for 75 ms
    # instead of 10.
    gc.freeze()
    _left_out.set()


def limit_free_memory() -> None:
    """Let the C library keep little of the memory that is freed."""
    # By default it keeps a store of freed memory for up to eight threads a core, and from the first large array that is
    # freed on it takes arrays of up to 32 MB from these stores, which break up: half a gigabyte after some minutes.
    with suppress(*OF_ANOTHER):
        adjust = ctypes.CDLL(None).mallopt
        adjust(M_MMAP_THRESHOLD, LARGE)
        adjust(M_TRIM_THRESHOLD, LARGE)
        adjust(M_ARENA_MAX, STORES)


def return_free_memory() -> None:
    """Return freed memory to the system; the C library otherwise keeps hundreds of megabytes of it."""
    with suppress(*OF_ANOTHER):
        ctypes.CDLL(None).malloc_trim(0)


def forget_ground() -> None:
    """Drop what is kept of the beds of scenes that are left, up to hundreds of megabytes; on a worker."""
    # lazy: loads kernels; the window opens before Numba is loaded
    from insonify.packing.terrain_tiles import drop_windows

    ARRAYS.clear()
    drop_windows()


class GcPolicy:
    """Collects young generations by Python's thresholds, and the oldest for a small share of the time."""

    # Objects are not counted: `gc.get_objects` refers to tuples that other threads are making, which then fail there.

    def __init__(self) -> None:
        self._next = 0.0  # time from which the oldest generation may be collected

    def collect(self) -> None:
        """Collect the generations that are due."""
        due = [count > limit for count, limit in zip(gc.get_count(), gc.get_threshold())]
        began = time.perf_counter()
        if due[OLDEST] and began >= self._next:
            gc.collect()
            self._next = began + (time.perf_counter() - began) / SHARE
        elif any(due[:OLDEST]):
            gc.collect(1 if due[1] else 0)
