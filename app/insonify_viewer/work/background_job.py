"""What every job beside the window has: a title, progress with the time left, an end, and a stop."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple

FEW = 0.02  # share done from which the time left is told


class State(Enum):
    """How far a job is."""

    RUNNING = "running"
    STOPPING = "stopping"
    DONE = "done"
    FAILED = "failed"
    STOPPED = "stopped"


class Stage(NamedTuple):
    """What a job does now, and how much of it is done."""

    doing: str = "starting"  # what it does, for the person
    done: float = 0.0  # how much is done, of how much; a total of 0 is not known
    total: float = 0.0
    unit: str = ""  # what is counted
    began: float = 0.0  # monotonic seconds at which it began, or went on after something else
    first: float = 0.0  # how much was done by then

    @property
    def share(self) -> float | None:
        """Share done; None where that is not known."""
        return min(self.done / self.total, 1.0) if self.total > 0.0 else None


class BackgroundJob(ABC):
    """Work beside the window that is listed with its progress.

    Parameters
    ----------
    title : str
        What it makes, for the person.
    result : Path or None
        The file or folder that it makes, if it makes one.
    call_later : callable
        Calls (receive, value) on the main thread.
    changed : callable
        Receives the job whenever it has something new to show, on the main thread.

    Attributes
    ----------
    state : State
    stage : Stage
    sentence : str
        What is said at its end: its result, or what is wrong.
    trace : str
        Where it went wrong, as Python tells it; empty for a mistake of the person, and for a job that did not fail.
    """

    def __init__(
        self,
        title: str,
        result: Path | None,
        call_later: Callable[[Callable[[Any], None], Any], None],
        changed: Callable[[BackgroundJob], None],
    ) -> None:
        self.title, self.result = title, result
        self._call_later, self._changed = call_later, changed
        self.state, self.stage = State.RUNNING, Stage(began=time.monotonic())
        self.sentence = self.trace = ""

    @property
    def running(self) -> bool:
        """Whether it still works."""
        return self.state in (State.RUNNING, State.STOPPING)

    @property
    def seconds_left(self) -> float | None:
        """Seconds that the stage will take at the rate so far; None while nobody can tell."""
        stage, lately = self.stage, self.stage.done - self.stage.first
        if stage.share is None or lately <= 0.0 or lately < FEW * stage.total or not self.running:
            return None
        return (time.monotonic() - stage.began) * max(stage.total - stage.done, 0.0) / lately

    @abstractmethod
    def start(self) -> None:
        """Begin."""

    def stop(self) -> None:
        """Ask the job to end; it leaves nothing half-written."""
        if self.state is State.RUNNING:
            self.state = State.STOPPING
            self._ask_to_end()
            self._changed(self)

    @abstractmethod
    def close(self, patience: float) -> None:
        """Stop, and wait for the end, at most for a time in seconds."""

    @abstractmethod
    def _ask_to_end(self) -> None: ...

    def _advance(self, stage: Stage) -> None:
        """Take over how far the work is."""
        before = self.stage
        if (stage.unit, stage.total) == (before.unit, before.total):
            self.stage = stage._replace(began=before.began, first=before.first)
        else:
            self.stage = stage._replace(began=time.monotonic(), first=stage.done)
        self._changed(self)

    def _finish(self, state: State, sentence: str, trace: str = "") -> None:
        """Take over how the work ended; whatever ends a job that was asked to end has stopped it."""
        if state is State.FAILED and self.state is State.STOPPING:
            state, sentence, trace = State.STOPPED, f"{self.title}: stopped", ""
        self.state, self.sentence, self.trace = state, sentence, trace
        self._changed(self)
