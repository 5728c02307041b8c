"""Work at a console: progress with the time left, what failed, and how to go on after an interruption."""

from __future__ import annotations

import sys
from typing import NamedTuple

from insonify.errors import SceneError
from insonify.progress import open_progress
from insonify.surveys.engine.jobs import Outcome, Work, prepare_folder
from insonify.surveys.engine.run import Failure, run_jobs, tell_failures

INTERRUPTED = 130


class Ended(NamedTuple):
    """A work whose jobs have all been tried."""

    done: list[str]  # jobs that are done, in order
    failures: tuple[Failure, ...]  # those that could not be done

    def refuse_failures(self) -> None:
        """Tell of jobs that could not be done, if there are any."""
        if self.failures:
            raise SceneError(tell_failures(self.failures, len(self.done) + len(self.failures)))


def work_on(work: Work, what: str, scheduler: str, unit: str = "job") -> Ended | None:
    """Do the jobs of a work that are not done yet, and show their progress."""
    names = list(work.names())
    missing = prepare_folder(work.folder, names, what)
    if not missing:
        return Ended(names, ())
    progress = _Progress(len(names), len(names) - len(missing), unit)
    try:
        tally = run_jobs(work.begun(), missing, scheduler, progress)
    except KeyboardInterrupt:
        progress.close()
        told = f"interrupted; {progress.done} of {len(names)} {unit}s are done and stay; the same command goes on"
        sys.stderr.write(f"insonify: {told}\n")
        return None
    finally:
        progress.close()
    failed = {failure.name for failure in tally.failures}
    return Ended([name for name in names if name not in failed], tally.failures)


class _Progress:
    """Number of jobs done, and its report."""

    def __init__(self, total: int, done: int, unit: str) -> None:
        self.done = done
        self._shown = open_progress("", total, unit, done=done)

    def __call__(self, ended: Outcome | Failure) -> None:
        self.done += isinstance(ended, Outcome)
        self._shown.advance(1)

    def close(self) -> None:
        self._shown.close()
