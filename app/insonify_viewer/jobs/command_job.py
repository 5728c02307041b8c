"""One command in a process of its own, with progress, time left and a stop."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple

from insonify.progress import VARIABLE
from insonify_viewer.thread_priority import yield_to_window

SAID_BY = "insonify: "  # begins a sentence of the command on standard error
FEW = 0.02  # share done from which the time left is told


class State(Enum):
    """How far a job is."""

    RUNNING = "running"
    STOPPING = "stopping"
    DONE = "done"
    FAILED = "failed"
    STOPPED = "stopped"


class Stage(NamedTuple):
    """What a job does now, how much of it is done, and when it began (monotonic seconds)."""

    doing: str = "starting"
    done: float = 0.0
    total: float = 0.0
    unit: str = ""
    began: float = 0.0

    @property
    def share(self) -> float | None:
        """Share done; None where that is not known."""
        return min(self.done / self.total, 1.0) if self.total > 0.0 else None


class CommandJob:
    """A command of ``insonify``, run as from a shell; the results are the same to the bit.

    Parameters
    ----------
    title : str
        What it makes, for the person.
    arguments : sequence of str
        Of the command.
    result : Path
        The file or folder that it makes.
    call_later : callable
        Calls (receive, value) on the main thread.
    changed : callable
        Receives the job whenever it has something new to show, on the main thread.

    Attributes
    ----------
    state : State
    stage : Stage
    sentence : str
        What the command said at its end: its result, or what is wrong.
    """

    def __init__(
        self,
        title: str,
        arguments: Sequence[str],
        result: Path,
        call_later: Callable[[Callable[[Any], None], Any], None],
        changed: Callable[[CommandJob], None],
    ) -> None:
        self.title, self.arguments, self.result = title, tuple(arguments), result
        self._call_later, self._changed = call_later, changed
        self.state, self.stage, self.sentence = State.RUNNING, Stage(began=time.monotonic()), ""
        self._process: subprocess.Popen[str] | None = None
        self._reader = threading.Thread(target=self._read, name="insonify job", daemon=True)

    @property
    def running(self) -> bool:
        """Whether the process still works."""
        return self.state in (State.RUNNING, State.STOPPING)

    @property
    def seconds_left(self) -> float | None:
        """Seconds that the stage will take at the rate so far; None while nobody can tell."""
        share = self.stage.share
        if share is None or share < FEW or not self.running:
            return None
        return (time.monotonic() - self.stage.began) * (1.0 - share) / share

    def start(self) -> None:
        """Start the process, at a lower priority than the window."""
        self._process = subprocess.Popen(
            [sys.executable, "-m", "insonify", *self.arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            env=os.environ | {VARIABLE: "lines", "PYTHONUTF8": "1"},
            start_new_session=True,  # so that a stop reaches the workers of the command too
        )
        yield_to_window(self._process.pid)
        self._reader.start()

    def stop(self) -> None:
        """Ask the process to end; it leaves nothing half-written."""
        if self.state is State.RUNNING:
            self.state = State.STOPPING
            self._send("SIGTERM")
            self._changed(self)

    def close(self, patience: float) -> None:
        """Stop, and end the process if it has not ended after a time in seconds."""
        if self._process is None:
            return
        self.stop()
        self._reader.join(patience)
        if self._process.poll() is None:
            self._send("SIGKILL")
        self._reader.join()
        if self.running:  # its end is not taken over any more
            self.state = State.STOPPED

    def _send(self, name: str) -> None:
        """Send a signal to the process and those that it started; end the process where there are no signals."""
        assert self._process is not None
        if self._process.poll() is not None:
            return
        if sys.platform == "win32":
            self._process.kill()
            return
        try:
            os.killpg(self._process.pid, getattr(signal, name))
        except ProcessLookupError:  # it ended just now
            return

    def _read(self) -> None:
        """Pass on what the process reports, until it ends; on a thread of its own."""
        process = self._process
        assert process is not None
        assert process.stderr is not None
        assert process.stdout is not None
        complaint = ""
        with process:
            for line in process.stderr:
                if stage := _stage_of(line):
                    self._call_later(self._advance, stage)
                elif line.startswith(SAID_BY):
                    complaint = line.removeprefix(SAID_BY).strip()
            said = process.stdout.read().strip()
        self._call_later(self._end, (process.returncode, said.rpartition("\n")[2], complaint))

    def _advance(self, stage: Stage) -> None:
        """Take over how far the process is."""
        before = self.stage
        same = (stage.unit, stage.total) == (before.unit, before.total)
        self.stage = stage._replace(began=before.began if same else time.monotonic())
        self._changed(self)

    def _end(self, outcome: tuple[int, str, str]) -> None:
        """Take over how the process ended."""
        code, said, complaint = outcome
        if code == 0:
            self.state, self.sentence = State.DONE, said or f"{self.result} is finished"
        elif self.state is State.STOPPING:
            self.state, self.sentence = State.STOPPED, f"{self.title}: stopped"
        else:
            self.state, self.sentence = State.FAILED, complaint or f"{self.title}: ended with code {code}"
        self._changed(self)


def _stage_of(line: str) -> Stage | None:
    """Parse a line of progress; None for another line."""
    if not line.startswith("{"):
        return None
    try:
        found = json.loads(line)
        return Stage(str(found["doing"]), float(found["done"]), float(found["total"]), str(found["unit"]))
    except (ValueError, KeyError, TypeError):
        return None
