"""The jobs of a window: what runs beside it, and what has ended."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from insonify.commands.render import PICTURE
from insonify.display.display_options import display_settings
from insonify.scene import Scene, scene_to_toml
from insonify_viewer.state.session import Session
from insonify_viewer.work.background_job import BackgroundJob
from insonify_viewer.work.command_job import CommandJob
from insonify_viewer.work.job import Progress
from insonify_viewer.work.thread_job import ThreadJob

Watcher = Callable[[BackgroundJob], None]


class JobList:
    """Commands and other long work that a window has started, the newest last."""

    def __init__(self, call_later: Callable[[Callable[[Any], None], Any], None]) -> None:
        self._call_later = call_later
        self._watchers: list[Watcher] = []
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._scenes = 0
        self.jobs: list[BackgroundJob] = []

    @property
    def running(self) -> tuple[BackgroundJob, ...]:
        """Jobs that have not ended, the newest last."""
        return tuple(job for job in self.jobs if job.running)

    def watch(self, watcher: Watcher) -> None:
        """Call a function with every job that begins, advances or ends."""
        self._watchers.append(watcher)

    def begin(self, title: str, arguments: Sequence[str], result: Path) -> CommandJob:
        """Start a command; arguments as of `CommandJob`."""
        job = CommandJob(title, arguments, result, self._call_later, self._tell)
        self._begin(job)
        return job

    def begin_work(self, title: str, work: Callable[[Progress], Any]) -> ThreadJob:
        """Start work whose result the window goes on with; arguments as of `ThreadJob`."""
        job = ThreadJob(title, work, self._call_later, self._tell)
        self._begin(job)
        return job

    def write_scene(self, scene: Scene) -> str:
        """Write a scene as it is now for a command to read, and return the file; it lasts as long as the window."""
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="insonify-jobs-")
        self._scenes += 1
        path = Path(self._folder.name, f"scene-{self._scenes}.toml")
        path.write_text(scene_to_toml(scene), encoding="utf-8")
        return str(path)

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
        self._watchers.clear()
        for job in self.running:
            job.stop()
        for job in self.running:
            job.close(patience)
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _begin(self, job: BackgroundJob) -> None:
        self.jobs.append(job)
        job.start()
        self._tell(job)

    def _tell(self, job: BackgroundJob) -> None:
        for watcher in self._watchers:
            watcher(job)
