"""Jobs: commands and other long work beside the window, with progress, the time left, and a stop."""

import json
import os
import subprocess
import tempfile
import threading
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import tomli_w
from psygnal import Signal

from insonify.child_process import own_command
from insonify.commands.render import PICTURE
from insonify.display.display_options import display_settings
from insonify.operating_system import apart, end_apart, lower_priority
from insonify.progress import VARIABLE
from insonify.scene import Scene, scene_to_toml
from insonify_viewer.errors import Failure, describe_error
from insonify_viewer.state.session import Session
from insonify_viewer.work.executor import CallLater, Progress

FEW = 0.02  # share done from which the time left is estimated
PREFIX = "insonify: "  # begins a sentence of the command on standard error
LINES = 200  # last lines of the command's standard error that are kept
WORKING, WHOLE = "working", 1.0  # the only stage of a `ThreadJob`


Job = TypeVar("Job", bound="BackgroundJob")


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
    """Work beside the window that is listed with its progress."""

    changed = Signal(object)  # the job, whenever it has something new to show

    def __init__(self, title: str, result: Path | None, call_later: CallLater) -> None:
        self.title, self.result = title, result  # what it makes, in words; the file or folder that it makes
        self._call_later = call_later
        self.state, self.stage = State.RUNNING, Stage(began=time.monotonic())
        self.sentence = ""  # said at its end: its result, or what is wrong
        self.trace = ""  # Python's traceback where it failed by a fault of the program

    @property
    def running(self) -> bool:
        """Whether it still works."""
        return self.state in (State.RUNNING, State.STOPPING)

    @property
    def seconds_left(self) -> float | None:
        """Seconds that the stage will take at the rate so far; None while it is unknown."""
        stage, lately = self.stage, self.stage.done - self.stage.first
        if stage.share is None or lately <= 0.0 or lately < FEW * stage.total or not self.running:
            return None
        return (time.monotonic() - stage.began) * max(stage.total - stage.done, 0.0) / lately

    @abstractmethod
    def start(self) -> None:
        """Begin."""

    def stop(self) -> None:
        """Stop the job; it leaves nothing half-written."""
        if self.state is State.RUNNING:
            self.state = State.STOPPING
            self._ask_to_end()
            self.changed.emit(self)

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
        self.changed.emit(self)

    def _finish(self, state: State, sentence: str, trace: str = "") -> None:
        """Take over how the work ended; a job that was being stopped counts as stopped, however it ends."""
        if state is State.FAILED and self.state is State.STOPPING:
            state, sentence, trace = State.STOPPED, f"{self.title}: stopped", ""
        self.state, self.sentence, self.trace = state, sentence, trace
        self.changed.emit(self)

    def _fail(self, failure: Failure) -> None:
        self._finish(State.FAILED, failure.sentence, failure.trace)


class CommandJob(BackgroundJob):
    """A command of ``insonify``, run as from a shell; the results are the same to the bit."""

    def __init__(self, title: str, arguments: Sequence[str], result: Path | None, call_later: CallLater) -> None:
        super().__init__(title, result, call_later)
        self.arguments = tuple(arguments)
        self._process: subprocess.Popen[str] | None = None
        self._reader = threading.Thread(target=self._read, name="insonify job", daemon=True)

    def start(self) -> None:
        """Start the process, at a lower priority than the window."""
        self._process = subprocess.Popen(
            own_command(*self.arguments),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            encoding="utf-8",
            errors="replace",
            env=os.environ | {VARIABLE: "lines", "PYTHONUTF8": "1"},
            **apart(),  # so that a stop reaches the workers of the command too
        )
        lower_priority(self._process.pid)
        self._reader.start()

    def close(self, patience: float) -> None:
        """Stop, and end the process if it has not ended after a time in seconds."""
        if self._process is None:
            return
        self.stop()
        self._reader.join(patience)
        end_apart(self._process, at_once=True)
        self._reader.join()
        if self.running:  # its end is not taken over any more
            self.state = State.STOPPED

    def _ask_to_end(self) -> None:
        assert self._process is not None
        end_apart(self._process)

    def _read(self) -> None:
        """Pass on what the process reports, until it ends; on a thread of its own."""
        process = self._process
        assert process is not None
        assert process.stderr is not None
        assert process.stdout is not None
        others: deque[str] = deque(maxlen=LINES)
        try:
            with process:
                for line in process.stderr:
                    if stage := _stage_of(line):
                        self._call_later(self._advance, stage)
                    else:
                        others.append(line)
                said = process.stdout.read().strip()
        except Exception as error:  # an exception that ends the thread would leave the window waiting
            self._call_later(self._fail, describe_error(error, f"the {self.title}"))
            return
        self._call_later(self._end, (process.returncode, said.rpartition("\n")[2], list(others)))

    def _end(self, outcome: tuple[int, str, list[str]]) -> None:
        """Take over how the process ended."""
        code, said, others = outcome
        if code == 0:
            self._finish(State.DONE, said or f"{self.result} is finished")
            return
        complaints = [line.removeprefix(PREFIX).strip() for line in others if line.startswith(PREFIX)]
        if complaints:
            self._finish(State.FAILED, complaints[-1])
        else:
            self._finish(State.FAILED, f"{self.title}: ended with code {code}", "".join(others))


def _stage_of(line: str) -> Stage | None:
    """Parse a line of progress; None for another line."""
    if not line.startswith("{"):
        return None
    try:
        found = json.loads(line)
        return Stage(str(found["doing"]), float(found["done"]), float(found["total"]), str(found["unit"]))
    except (ValueError, KeyError, TypeError, OverflowError):
        return None


class StoppedError(Exception):
    """The job was stopped."""


class ThreadJob(BackgroundJob):
    """Work that results in an object for the window, on a thread of its own."""

    def __init__(self, title: str, work: Callable[[Progress], Any], call_later: CallLater) -> None:
        super().__init__(title, None, call_later)
        self.value: Any = None
        self._do = work
        self._share: float | None = None  # reported and not passed on yet
        self.thread = threading.Thread(target=self._work, name=f"insonify {title}", daemon=True)

    def start(self) -> None:
        """Start the thread, which works from its first moment on."""
        self.stage = self.stage._replace(doing=WORKING, total=WHOLE)
        self.thread.start()

    def close(self, patience: float) -> None:
        """Stop at the next report of progress, and wait for the thread, at most for a time in seconds."""
        self.stop()
        self.thread.join(patience)
        if self.running:  # its end is not taken over any more
            self.state = State.STOPPED

    def _ask_to_end(self) -> None:
        """Leave it to the next report of progress, which ends the work."""

    def _work(self) -> None:
        lower_priority()
        try:
            self._call_later(self._take, self._do(self._report))
        except StoppedError:
            self._call_later(self._fail, Failure(""))
        except Exception as error:  # an exception that ends the thread would leave the window waiting
            self._call_later(self._fail, describe_error(error, f"the {self.title}"))

    def _report(self, share: float) -> None:
        if self.state is State.STOPPING:
            raise StoppedError
        waits, self._share = self._share is not None, share
        if not waits:  # otherwise the report that waits passes this share on: work may report faster than Qt delivers
            self._call_later(self._pass_on, None)

    def _pass_on(self, _: None) -> None:
        share, self._share = self._share, None
        if share is not None:
            self._advance(Stage(WORKING, share, WHOLE))

    def _take(self, value: Any) -> None:
        self.value = value
        self._finish(State.DONE, f"{self.title} is finished")


class JobList:
    """Commands and other long work that a window has started, the newest last."""

    changed = Signal(object)  # a `BackgroundJob` that begins, advances or ends

    def __init__(self, call_later: CallLater) -> None:
        self._call_later = call_later
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._files = 0
        self.jobs: list[BackgroundJob] = []

    @property
    def running(self) -> tuple[BackgroundJob, ...]:
        """Jobs that have not ended, the newest last."""
        return tuple(job for job in self.jobs if job.running)

    def begin(self, title: str, arguments: Sequence[str], result: Path | None) -> CommandJob:
        """Start a command; arguments as of `CommandJob`."""
        return self._begin(CommandJob(title, arguments, result, self._call_later))

    def begin_work(self, title: str, work: Callable[[Progress], Any]) -> ThreadJob:
        """Start work that results in an object for the window; arguments as of `ThreadJob`."""
        return self._begin(ThreadJob(title, work, self._call_later))

    def write_scene(self, scene: Scene) -> str:
        """Write a scene as it is now for a command to read, and return the file; it lasts as long as the window."""
        return self._write("scene", scene_to_toml(scene))

    def write_specification(self, scene: Scene, specification: Mapping[str, Any]) -> str:
        """Write a specification on the base of a scene, as `write_scene` does."""
        return self._write("specification", tomli_w.dumps({"base": self.write_scene(scene), **specification}))

    def write_record(self, session: Session, path: Path) -> CommandJob:
        """Write every ping of the scene of a session, modelled and displayed as there, as data or as a picture."""
        scene, modelling, display = session.scene, session.modelling, display_settings(session.display)
        forced = [word for subject, choice in modelling.forced for word in ("--model", f"{subject}={choice}")]
        arguments = ["render", self.write_scene(scene), "-o", str(path), "--tolerance", repr(modelling.tolerance)]
        shown = [word for setting in display for word in ("--display", setting)] if path.suffix == PICTURE else []
        return self.begin(f"writing {path.name}", [*arguments, *forced, *shown], path)

    def forget_ended(self) -> None:
        """Leave the jobs that have ended out of the list; their results stay."""
        self.jobs = list(self.running)

    def close(self, patience: float) -> None:
        """Stop all jobs, and end those that have not ended after a time in seconds."""
        self.changed.disconnect()
        for job in self.running:
            job.stop()
        for job in self.running:
            job.close(patience)
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _write(self, name: str, text: str) -> str:
        """Write a file that lasts as long as the window, and return its path."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="insonify-jobs-")
        self._files += 1
        path = Path(self._folder.name, f"{name}-{self._files}.toml")
        path.write_text(text, encoding="utf-8", newline="")
        return str(path)

    def _begin(self, job: Job) -> Job:
        self.jobs.append(job)
        job.changed.connect(lambda changed: self.changed.emit(changed))
        job.start()
        self.changed.emit(job)
        return job
