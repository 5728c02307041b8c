"""Garbage collection on the main thread alone.

Widgets refer to one another in cycles. Python collects cycles on whichever thread allocates next. On a worker thread
that would destroy widgets and their OpenGL contexts while the main thread draws, which stalls or ends the program.
"""

from __future__ import annotations

import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager

OLDEST = 2  # generation
GROWTH = 1.25  # growth of the oldest generation that starts a full collection, as in CPython's own rule


@contextmanager
def collected_by_hand() -> Iterator[GcPolicy]:
    """Turn automatic collection off until the block ends, and collect everything then.

    Objects that exist before are frozen meanwhile: they are mostly those of libraries, which take long to traverse.

    Yields
    ------
    GcPolicy
        To be called regularly on the main thread.
    """
    gc.disable()
    gc.freeze()
    try:
        yield GcPolicy()
    finally:
        gc.collect()
        gc.unfreeze()
        gc.enable()


def return_free_memory() -> None:
    """Return freed memory to the system; the C library otherwise keeps hundreds of megabytes of it."""
    try:
        ctypes.CDLL(None).malloc_trim(0)
    except (AttributeError, OSError, TypeError):  # another C library
        return


class GcPolicy:
    """Collects young generations by Python's thresholds, and the oldest when it has grown."""

    def __init__(self) -> None:
        self._old = 0

    def collect(self) -> None:
        """Collect the generations that are due."""
        due = [count > limit for count, limit in zip(gc.get_count(), gc.get_threshold())]
        if due[OLDEST] and len(gc.get_objects(OLDEST)) > GROWTH * self._old:
            gc.collect()
            self._old = len(gc.get_objects(OLDEST))
        elif any(due[:OLDEST]):
            gc.collect(1 if due[1] else 0)
