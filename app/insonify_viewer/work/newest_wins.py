"""A thread that always takes the newest errand, for answers that only the latest question needs."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from insonify.scene import SceneError
from insonify_viewer.errors.fault_report import FaultReport, report_fault
from insonify_viewer.work.thread_priority import yield_to_window

Errand = tuple[Callable[[], Any], Callable[[Any], None]]


class NewestWins:
    """Runs errands one at a time; a new one replaces one that still waits. The thread begins with the first."""

    def __init__(self, name: str, call_later: Callable[[Callable[[Any], None], Any], None]) -> None:
        self._call_later, self._faults = call_later, FaultReport()
        self._waiting: Errand | None = None
        self._closing = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._work, name=f"insonify {name}", daemon=True)

    def send(self, errand: Callable[[], Any], receive: Callable[[Any], None]) -> None:
        """Run an errand next and pass its result to the main thread.

        The result of one that raises is None. A `SceneError` says no more than the worker says of the scene; any other
        exception is a fault of the program and is reported, a repeated one once.
        """
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
            self._run(errand, receive)

    def _run(self, errand: Callable[[], Any], receive: Callable[[Any], None]) -> None:
        """Run an errand; without its answer the caller shows what it has."""
        try:
            result = errand()
        except SceneError:
            self._call_later(receive, None)
        except Exception as error:
            self._call_later(receive, None)
            if self._faults.is_news(error):
                self._call_later(report_fault, error)
        else:
            self._faults.forget()
            self._call_later(receive, result)
