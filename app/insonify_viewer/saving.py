"""Saves scene, record and picture, and asks before unsaved changes are lost."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from insonify.io.atomic import replacing
from insonify.scene import Scene, scene_to_toml
from insonify_viewer.jobs.job_list import JobList
from insonify_viewer.session import Session
from insonify_viewer.views.save_dialogs import (
    PICTURE,
    Answer,
    ask_about_changes,
    ask_about_jobs,
    ask_where_to_save,
    record_formats,
    save_picture,
)

if TYPE_CHECKING:
    from insonify_viewer.views.main_window import MainWindow

SCENE = ".toml"


class Saving:
    """Saves what the window shows.

    Parameters
    ----------
    session : Session
        The scene and its modelling.
    window : MainWindow
        Its actions ask for saving.
    jobs : JobList
        Writes the record.
    """

    def __init__(self, session: Session, window: MainWindow, jobs: JobList) -> None:
        self._session, self._window, self._jobs = session, window, jobs
        self._folder = ""
        window.save.scene.triggered.connect(self.save_scene)
        window.save.record.triggered.connect(self.save_record)
        window.save.picture.triggered.connect(self.save_window)

    def may_leave(self) -> bool:
        """Ask what becomes of unsaved changes; return whether the scene may be left."""
        if not self._session.unsaved:
            return True
        answer = ask_about_changes(self._window, self._session.scene.title)
        return answer is Answer.DISCARD or (answer is Answer.SAVE and self.save_scene())

    def may_close(self) -> bool:
        """Ask about unsaved changes and about jobs that run; return whether the window may be closed."""
        return self.may_leave() and (not self._jobs.running or ask_about_jobs(self._window, len(self._jobs.running)))

    def save_scene(self) -> bool:
        """Write the scene to a file that the person names; return whether it was written."""
        scene = self._session.scene
        suggestion = self._session.file or self._suggest(SCENE)
        path = ask_where_to_save(self._window, "Save the scene", suggestion, [("Scenes", SCENE)])
        if path is None or not self._try(lambda: _write_scene(scene, path), path):
            return False
        self._session.mark_saved(str(path))
        return True

    def save_record(self) -> None:
        """Simulate the whole record and write it to a file that the person names."""
        formats = record_formats()
        path = ask_where_to_save(self._window, "Save the record", self._suggest(formats[0][1]), formats)
        if path is not None:
            self._jobs.write_record(self._session, path)

    def save_window(self) -> None:
        """Write a picture of the window to a file that the person names."""
        path = ask_where_to_save(self._window, "Save the window", self._suggest(PICTURE), [("Pictures", PICTURE)])
        if path is not None:
            self._try(lambda: save_picture(self._window, path), path)

    def _try(self, save: Callable[[], None], path: Path) -> bool:
        """Write a file and say so, or why it was not written."""
        self._folder = str(path.parent)
        try:
            save()
        except OSError as error:
            self._window.complain(error)
            return False
        self._window.say(f"saved {path}")
        return True

    def _suggest(self, suffix: str) -> str:
        """Suggest a file name by the title of the scene."""
        words = re.findall(r"[a-z0-9]+", self._session.scene.title.lower())
        return str(Path(self._folder, "-".join(words[:6]) or "scene").with_suffix(suffix))


def _write_scene(scene: Scene, path: Path) -> None:
    with replacing(path) as beside:
        beside.write_text(scene_to_toml(scene), encoding="utf-8")
