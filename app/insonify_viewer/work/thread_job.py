"""Work on a thread of the window's own process, listed as a job."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from insonify_viewer.errors.failure import Failure
from insonify_viewer.work.background_job import BackgroundJob, Stage, State
from insonify_viewer.work.job import Job, Progress

WORKING, WHOLE = "working", 1.0  # the only stage


class ThreadJob(BackgroundJob):
    """Work whose result is an object that the window goes on with."""

    def __init__(
        self,
        title: str,
        work: Callable[[Progress], Any],
        call_later: Callable[[Callable[[Any], None], Any], None],
        changed: Callable[[BackgroundJob], None],
    ) -> None:
        super().__init__(title, None, call_later, changed)
        self.value: Any = None
        self._job = Job(work, call_later, progressed=self._reach, done=self._take, failed=self._fail, name=title)

    def start(self) -> None:
        """Start the thread, which works from its first moment on."""
        self.stage = self.stage._replace(doing=WORKING, total=WHOLE)
        self._job.start()

    def close(self, patience: float) -> None:
        """Stop at the next report of progress, and wait for the thread, at most for a time in seconds."""
        self._job.close(patience)
        if self.running:  # its end is not taken over any more
            self.state = State.STOPPED

    def _ask_to_end(self) -> None:
        self._job.stop()

    def _reach(self, share: float) -> None:
        self._advance(Stage(WORKING, share, WHOLE))

    def _take(self, value: Any) -> None:
        self.value = value
        self._finish(State.DONE, f"{self.title} is finished")

    def _fail(self, failure: Failure) -> None:
        self._finish(State.FAILED, failure.sentence, failure.trace)
