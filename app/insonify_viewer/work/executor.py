"""Work beside the window: threads by key on which the newest work wins."""

import math
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from PySide6.QtCore import QObject, Qt, Signal

from insonify.operating_system import lower_priority
from insonify_viewer.errors import Failure, FaultReport, describe_error

Work = Callable[[], Any]
Receive = Callable[[Any], None]
CallLater = Callable[[Receive, Any], None]
Progress = Callable[[float], None]

QUIET, LONGEST = 0.1, 0.7  # s without other work before patient work begins, and its longest wait


class Executor(QObject):
    """Runs work on threads of its own and passes the results to the main thread."""

    # Work has a key, and each key its thread, which begins with the first work: work replaces work of the same key
    # that still waits. Work that is started has a thread to itself.

    _posted = Signal(object, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.lanes: dict[str, Lane] = {}
        self._started: list[threading.Thread] = []
        self._faults: dict[str, FaultReport] = {}
        self._closing = False
        self._posted.connect(self._call, Qt.ConnectionType.QueuedConnection)

    def submit(self, key: str, work: Work, receive: Receive) -> None:
        """Run work on the thread of a key and pass its result to the main thread, or None where it raises."""
        # What it raises is reported, a repeated exception once.
        if key not in self.lanes:
            self.lanes[key], self._faults[key] = Lane(key, self.call_later), FaultReport()
        self.lanes[key].put(key, lambda: _outcome(work), lambda outcome: self._take(key, receive, *outcome))

    def start(self, name: str, work: Work, *, done: Receive, failed: Callable[[Failure], None]) -> None:
        """Run work on a thread of its own, and pass its result or what went wrong to the main thread."""

        def run() -> None:
            lower_priority()
            result, error = _outcome(work)
            if error is None:
                self.call_later(done, result)
            else:
                self.call_later(failed, describe_error(error, f"the {name}"))

        thread = threading.Thread(target=run, name=f"insonify {name}", daemon=True)
        self._started = [*(each for each in self._started if each.is_alive()), thread]
        thread.start()

    def call_later(self, receive: Receive, result: Any) -> None:
        """Pass a result from any thread to the main thread; it is dropped once the window closes."""
        # A thread that compiles outlives the window, and Qt's half of this object when the interpreter ends.
        with suppress(RuntimeError):
            self._posted.emit(receive, result)

    def close(self, patience: float | None = None) -> None:
        """End all threads, and wait for each at most for a time in seconds: it may be compiling."""
        self._closing = True
        for lane in self.lanes.values():
            lane.close(patience)
        for thread in self._started:
            thread.join(patience)

    def _take(self, key: str, receive: Receive, result: Any, error: Exception | None) -> None:
        """Pass a result on, then report an error that is news for the key."""
        try:
            receive(result)
        finally:  # the error may be why there is nothing to receive
            self._faults[key].report(error)

    def _call(self, receive: Receive, result: Any) -> None:
        if not self._closing:  # a result may still be queued when the window closes
            receive(result)


def _outcome(work: Work) -> tuple[Any, Exception | None]:
    try:
        return work(), None
    except Exception as error:
        return None, error


@dataclass
class _Waiting:
    """Work that waits for the thread of a lane."""

    work: Work
    receive: Receive
    rank: int  # lower ranks begin first
    due: float = 0.0  # time from which patient work may begin, unless other work comes
    latest: float = math.inf  # time from which it begins before all other work

    @property
    def begins(self) -> float:
        """Time from which it may begin."""
        return min(self.due, self.latest)


class Lane:
    """A thread and the work that waits for it; work of a key replaces work of the same key that still waits."""

    def __init__(self, name: str, call_later: CallLater) -> None:
        self._call_later = call_later
        self._waiting: dict[object, _Waiting] = {}
        self.closing = False
        self.changed = threading.Condition()
        self.thread = threading.Thread(target=self._work, name=f"insonify {name}", daemon=True)

    def put(self, key: object, work: Work, receive: Receive, *, rank: int = 1, patient: bool = False) -> None:
        """Run work next, before work of a higher rank; patient work waits for a moment without other work."""
        with self.changed:
            before, waiting = self._waiting.get(key), _Waiting(work, receive, rank)
            if patient:
                now = time.perf_counter()
                waiting.due, waiting.latest = now + QUIET, before.latest if before else now + LONGEST
            self._waiting[key] = waiting
            self.changed.notify()
            if not self.thread.is_alive() and not self.closing:
                self.thread.start()

    def is_interrupted_by(self, key: object) -> bool:
        """Whether work of a key waits, or the thread is to end."""
        return self.closing or key in self._waiting

    def close(self, patience: float | None = None) -> None:
        """End the thread and wait for it, at most for a time in seconds."""
        with self.changed:
            self.closing = True
            self.changed.notify()
        if self.thread.is_alive():
            self.thread.join(patience)

    def _work(self) -> None:
        lower_priority()
        while (waiting := self._next()) is not None:
            self._call_later(waiting.receive, waiting.work())

    def _next(self) -> _Waiting | None:
        """Wait for work that may begin, and take it; None if the thread is to end."""
        with self.changed:
            now = time.perf_counter()
            for each in self._waiting.values():
                each.due = each.due and now + QUIET  # the thread was busy until now
            while not self.closing:
                now = time.perf_counter()
                ready = {
                    key: each.rank if each.latest > now else 0
                    for key, each in self._waiting.items()
                    if each.begins <= now
                }
                if ready:
                    return self._waiting.pop(min(ready, key=ready.__getitem__))
                begins = min((each.begins for each in self._waiting.values()), default=None)
                self.changed.wait(None if begins is None else begins - now)
            return None
