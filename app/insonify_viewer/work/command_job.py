"""One command in a process of its own, with progress, time left and a stop."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from insonify.progress import VARIABLE
from insonify_viewer.work.background_job import BackgroundJob, Stage, State
from insonify_viewer.work.thread_priority import yield_to_window

SAID_BY = "insonify: "  # begins a sentence of the command on standard error
LINES = 200  # of what the command said on standard error that are kept


class CommandJob(BackgroundJob):
    """A command of ``insonify``, run as from a shell; the results are the same to the bit."""

    def __init__(
        self,
        title: str,
        arguments: Sequence[str],
        result: Path,
        call_later: Callable[[Callable[[Any], None], Any], None],
        changed: Callable[[BackgroundJob], None],
    ) -> None:
        super().__init__(title, result, call_later, changed)
        self.arguments = tuple(arguments)
        self._process: subprocess.Popen[str] | None = None
        self._reader = threading.Thread(target=self._read, name="insonify job", daemon=True)

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

    def _ask_to_end(self) -> None:
        self._send("SIGTERM")

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
        heard: deque[str] = deque(maxlen=LINES)
        with process:
            for line in process.stderr:
                if stage := _stage_of(line):
                    self._call_later(self._advance, stage)
                else:
                    heard.append(line)
            said = process.stdout.read().strip()
        self._call_later(self._end, (process.returncode, said.rpartition("\n")[2], list(heard)))

    def _end(self, outcome: tuple[int, str, list[str]]) -> None:
        """Take over how the process ended."""
        code, said, heard = outcome
        if code == 0:
            self._finish(State.DONE, said or f"{self.result} is finished")
            return
        complaints = [line.removeprefix(SAID_BY).strip() for line in heard if line.startswith(SAID_BY)]
        if complaints:
            self._finish(State.FAILED, complaints[-1])
        else:
            self._finish(State.FAILED, f"{self.title}: ended with code {code}", "".join(heard))


def _stage_of(line: str) -> Stage | None:
    """Parse a line of progress; None for another line."""
    if not line.startswith("{"):
        return None
    try:
        found = json.loads(line)
        return Stage(str(found["doing"]), float(found["done"]), float(found["total"]), str(found["unit"]))
    except (ValueError, KeyError, TypeError):
        return None
