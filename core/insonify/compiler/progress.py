"""Progress of compilation: which kernel is being compiled, which share is done, and about how long the rest takes.

A kernel is compiled when it is first called, and its machine code is kept on disk. To show a bar meanwhile::

    with watch_compilation(show):
        record = simulation.intensity(pings)

``show`` gets a `Compilation` whenever a function of a kernel is finished, and None when the kernel is. It is called by
the thread that compiles, which holds Numba's lock: it should only hand the values on. `Compilation.by_now` is the
progress between two reports. Nothing is reported of kernels whose machine code is found on disk. Watchers get the
compilations of all threads.
"""

import contextlib
import math
import time
from collections.abc import Callable, Iterator
from typing import NamedTuple, Self

MINUTE = 60.0
NEARLY = 0.98  # greatest share of the predicted time that is taken as passed


class Compilation(NamedTuple):
    """How far the compilation of one kernel has come."""

    subject: str  # calculation of the kernel in words: "bent rays"
    done: float  # share of its time, 0 to 1; never falls
    seconds_left: float | None  # about; None at the beginning
    reported: float = math.inf  # when, by `time.monotonic`

    @property
    def by_now(self) -> Self:
        """Progress at present, as predicted by the last report."""
        # The longest step comes last, when a kernel is optimised as a whole: nothing is reported meanwhile.
        if self.seconds_left is None:
            return self
        passed = min(max(time.monotonic() - self.reported, 0.0) / self.seconds_left, NEARLY)
        return self._replace(
            done=self.done + (1.0 - self.done) * passed, seconds_left=self.seconds_left * (1.0 - passed)
        )

    @property
    def sentence(self) -> str:
        """What is compiled and how long it takes, for people."""
        return f"compiling {self.subject}, once, {_about(self.seconds_left)}"


Watcher = Callable[[Compilation | None], None]
_watchers: list[Watcher] = []


@contextlib.contextmanager
def watch_compilation(watcher: Watcher) -> Iterator[None]:
    """Call ``watcher`` with every `Compilation`, and with None when its kernel is finished, while the context lasts."""
    _watchers.append(watcher)
    try:
        yield
    finally:
        _watchers.remove(watcher)


def report_progress(compilation: Compilation | None) -> None:
    """Report the progress of a compilation to all watchers."""
    for watcher in tuple(_watchers):
        watcher(compilation)


def _about(seconds: float | None) -> str:
    """Round a time and put it in words."""
    if seconds is None:
        return "this takes a while"
    if seconds < 0.75 * MINUTE:
        return f"about {max(5 * round(seconds / 5.0), 5)} s left"
    minutes = max(round(seconds / MINUTE), 1)
    return "about a minute left" if minutes == 1 else f"about {minutes} minutes left"
