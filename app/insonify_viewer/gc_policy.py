"""Collects what refers to itself on the main thread alone.

Windows are full of such cycles. Python collects them on whichever thread happens to allocate next; on a worker that
tears widgets and their OpenGL contexts down beside the main thread that draws, which stalls or ends the program.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QTimer

EVERY = 200  # ms
OLDEST = 2  # generation
GROWTH = 1.25  # of what is old, before it is gone through again; Python's own rule


@contextmanager
def collecting_here() -> Iterator[None]:
    """Collect on the calling thread only, whenever its event loop runs, until left; then once more, all there is.

    What was there before is left alone meanwhile: libraries, mostly, which take long to go through.
    """
    gc.disable()
    gc.freeze()
    rounds = _Rounds()
    timer = QTimer()
    timer.timeout.connect(rounds.collect)
    timer.start(EVERY)
    try:
        yield
    finally:
        timer.stop()
        gc.collect()
        gc.unfreeze()
        gc.enable()


class _Rounds:
    """Goes through what is young as often as Python would, through what is old once there is more of it."""

    def __init__(self) -> None:
        self._old = 0

    def collect(self) -> None:
        due = [count > limit for count, limit in zip(gc.get_count(), gc.get_threshold())]
        if due[OLDEST] and len(gc.get_objects(OLDEST)) > GROWTH * self._old:
            gc.collect()
            self._old = len(gc.get_objects(OLDEST))
        elif any(due[:OLDEST]):
            gc.collect(1 if due[1] else 0)
