"""Progress of long work: a bar on a terminal, or lines for a program that started the command."""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING, Any

from insonify.compiler.progress import Compilation

if TYPE_CHECKING:
    from tqdm import tqdm

DELAY = 2.0  # s, of compilation before the bar appears
# Environment variable; ``lines`` sets one JSON object a line on standard error instead of a bar. Each holds ``doing``
# (words), ``done`` and ``total`` (numbers) and ``unit``.
VARIABLE = "INSONIFY_PROGRESS"
APART = 0.1  # s, between two lines
WAITING = 0.5  # s, between two looks at work of unknown length
LEAST_WAITING = 1.0  # s, before a terminal shows it
PREPARING = "preparing the bed and the plan"
BARE = "{desc} {percentage:3.0f} % |{bar}|"  # bar of a share, which has no unit to count


class CompilationBar:
    """Watcher of compilation that reports how far it is."""

    def __init__(self) -> None:
        self._progress: Progress | None = None

    def __call__(self, compilation: Compilation | None) -> None:
        """Report a compilation, or that a kernel is finished."""
        if compilation is not None:
            if self._progress is None:
                self._progress = open_progress(compilation.sentence, 1.0, delay=DELAY)
            self._progress.say(compilation.sentence)
            self._progress.reach(compilation.done)
        elif self._progress is not None:
            self._progress.close()
            self._progress = None


class _Bar:
    """A bar on a terminal; nothing where standard error is none."""

    def __init__(self, doing: str, total: float, unit: str, done: float, delay: float) -> None:
        # lazy: most commands end before a bar would appear
        from tqdm import tqdm

        look: dict[str, Any] = {"unit": unit} if unit else {"bar_format": BARE, "mininterval": 0.0, "miniters": 0}
        look |= {"leave": False, "smoothing": 0.05, "disable": None if sys.stderr else True}
        self._bar: tqdm[Any] = tqdm(desc=doing or None, total=total, initial=done, delay=delay, **look)

    def advance(self, more: float) -> None:
        self._bar.update(more)

    def reach(self, done: float) -> None:
        self._bar.update(max(done - self._bar.n, 0))

    def say(self, doing: str) -> None:
        self._bar.set_description_str(doing, refresh=False)

    def close(self) -> None:
        self._bar.close()


class _Lines:
    """Lines for a program."""

    def __init__(self, doing: str, total: float, unit: str, done: float) -> None:
        self._doing, self._total, self._unit, self._done = doing, total, unit, done
        self._written = 0.0
        self._write()

    def advance(self, more: float) -> None:
        self.reach(self._done + more)

    def reach(self, done: float) -> None:
        self._done = max(done, self._done)
        if time.monotonic() - self._written >= APART:
            self._write()

    def say(self, doing: str) -> None:
        self._doing = doing

    def close(self) -> None:
        self._write()

    def _write(self) -> None:
        self._written = time.monotonic()
        line = {"doing": self._doing, "done": self._done, "total": self._total, "unit": self._unit}
        sys.stderr.write(f"{json.dumps(line)}\n")
        sys.stderr.flush()


Progress = _Bar | _Lines  # words, and an amount done of a total, which never falls


def open_progress(doing: str, total: float, unit: str = "", *, done: float = 0, delay: float = 0.0) -> Progress:
    """Begin to report the progress of long work."""
    if os.environ.get(VARIABLE) == "lines":
        return _Lines(doing, total, unit, done)
    return _Bar(doing, total, unit, done, delay)


def report_progress(doing: str, total: float, unit: str = "", *, delay: float = 0.0) -> closing[Progress]:
    """Report progress while the context lasts; arguments as of `open_progress`."""
    return closing(open_progress(doing, total, unit, delay=delay))


@contextmanager
def report_waiting(doing: str = PREPARING) -> Iterator[None]:
    """Report work of unknown length: what is being done, and on a terminal for how long so far."""
    if os.environ.get(VARIABLE) == "lines":
        _Lines(doing, 1.0, "", 0.0)
        yield
        return
    done = threading.Event()
    clock = threading.Thread(target=_show_waiting, args=(doing, done), daemon=True)
    clock.start()
    try:
        yield
    finally:
        done.set()
        clock.join()


def _show_waiting(doing: str, done: threading.Event) -> None:
    """Show the seconds on a terminal until the work is done."""
    began = time.time()
    if done.wait(LEAST_WAITING):
        return
    # lazy: most commands end before it would appear
    from tqdm import tqdm

    disable = None if sys.stderr else True
    with tqdm(desc=doing, bar_format="{desc}: {elapsed}", leave=False, disable=disable, delay=WAITING) as line:
        line.start_t = began
        while not done.wait(WAITING):
            line.refresh()
