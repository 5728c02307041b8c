"""A thread that always takes the newest errand, for answers that only the latest question needs."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from insonify_viewer.thread_priority import yield_to_window

Errand = tuple[Callable[[], Any], Callable[[Any], None]]


class NewestWins:
    """Runs errands one at a time; a new one replaces one that still waits. The thread begins with the first.

    Parameters
    ----------
    name : str
        Of the thread.
    call_later : callable
        Calls (receive, result) on the main thread.
    """

    def __init__(self, name: str, call_later: Callable[[Callable[[Any], None], Any], None]) -> None:
        self._call_later = call_later
        self._waiting: Errand | None = None
        self._closing = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._work, name=f"insonify {name}", daemon=True)

    def send(self, errand: Callable[[], Any], receive: Callable[[Any], None]) -> None:
        """Run an errand next and pass its result to the main thread; the result of one that raises is None."""
        with self._changed:
            self._waiting = (errand, receive)
            self._changed.notify()
            if not self._thread.is_alive() and not self._closing:
                self._thread.start()

    def close(self, patience: float | None = None) -> None:
        """End the thread and wait for it, at most for a time in seconds."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        if self._thread.is_alive():
            self._thread.join(patience)

    def _work(self) -> None:
        yield_to_window()
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._closing)
                if self._closing or self._waiting is None:
                    return
                (errand, receive), self._waiting = self._waiting, None
            try:
                result = errand()
            except Exception:  # the caller shows what it has without the answer
                result = None
            self._call_later(receive, result)
