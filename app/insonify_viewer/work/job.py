"""One piece of long work on a thread of its own, with progress and a stop."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from insonify_viewer.errors.failure import Failure, describe_error
from insonify_viewer.work.thread_priority import yield_to_window

Progress = Callable[[float], None]


class StoppedError(Exception):
    """The work was stopped."""


class Job:
    """Long work beside the window."""

    def __init__(
        self,
        work: Callable[[Progress], Any],
        call_later: Callable[[Callable[[Any], None], Any], None],
        *,
        progressed: Progress,
        done: Callable[[Any], None],
        failed: Callable[[Failure], None],
        name: str,
    ) -> None:
        self._do, self._name = work, name
        self._call_later, self._progressed, self._done, self._failed = call_later, progressed, done, failed
        self._stopping = False
        self._share: float | None = None  # reported and not passed on yet
        self._thread = threading.Thread(target=self._work, name=f"insonify {name}", daemon=True)

    @property
    def running(self) -> bool:
        """Whether the thread still works."""
        return self._thread.is_alive()

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop at the next report of progress."""
        self._stopping = True

    def close(self, patience: float | None = None) -> None:
        """Stop, and wait for the thread, at most for a time in seconds."""
        self.stop()
        self._thread.join(patience)

    def _work(self) -> None:
        yield_to_window()
        try:
            self._call_later(self._done, self._do(self._report))
        except StoppedError:
            self._call_later(self._failed, Failure(""))
        except Exception as error:  # an exception that ends the thread would leave the window waiting
            self._call_later(self._failed, describe_error(error, f"the {self._name}"))

    def _report(self, share: float) -> None:
        if self._stopping:
            raise StoppedError
        told, self._share = self._share is not None, share
        if not told:  # a report that waits will tell of this one too: work may report faster than a window listens
            self._call_later(self._pass_on, None)

    def _pass_on(self, _: None) -> None:
        share, self._share = self._share, None
        if share is not None:
            self._progressed(share)
