"""Saves scene, record and picture, and asks before unsaved changes are lost."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from insonify.commands.render import PICTURE, write
from insonify.display.display_options import DisplayOptions
from insonify.io.atomic import replacing
from insonify.io.records import RECORDS
from insonify.scene import Scene, scene_to_toml
from insonify_viewer.job import Job, Progress, in_one_sentence
from insonify_viewer.modelling import Modelling
from insonify_viewer.session import Session
from insonify_viewer.views.save_dialogs import Answer, ask_about_changes, ask_where_to_save, save_picture

if TYPE_CHECKING:
    from insonify_viewer.simulator import Simulator
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
    simulator : Simulator
        Passes results to the main thread.
    """

    def __init__(self, session: Session, window: MainWindow, simulator: Simulator) -> None:
        self._session, self._window, self._simulator = session, window, simulator
        self._job: Job | None = None
        self._folder = ""
        window.save.scene.triggered.connect(self.save_scene)
        window.save.record.triggered.connect(self.save_record)
        window.save.picture.triggered.connect(self.save_window)

    @property
    def busy(self) -> bool:
        """Whether a record is being written."""
        return self._job is not None

    def may_leave(self) -> bool:
        """Ask what becomes of unsaved changes; return whether the scene may be left."""
        if not self._session.unsaved:
            return True
        answer = ask_about_changes(self._window, self._session.scene.title)
        return answer is Answer.DISCARD or (answer is Answer.SAVE and self.save_scene())

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
        if self._job is not None:
            self._window.say("a record is being written already; wait for it")
            return
        names = {suffix: each.description for each in RECORDS.formats() for suffix in each.suffixes}
        formats = [*((names[suffix], suffix) for suffix in RECORDS.writable()), ("picture", PICTURE)]
        path = ask_where_to_save(self._window, "Save the record", self._suggest(formats[0][1]), formats)
        if path is not None:
            self._write_record(path)

    def save_window(self) -> None:
        """Write a picture of the window to a file that the person names."""
        path = ask_where_to_save(self._window, "Save the window", self._suggest(PICTURE), [("Pictures", PICTURE)])
        if path is not None:
            self._try(lambda: save_picture(self._window, path), path)

    def close(self, patience: float | None = None) -> None:
        """Stop writing; nothing is left of an unfinished record, unless it takes longer than a time in seconds."""
        if self._job is not None:
            self._job.close(patience)
            self._job = None

    def _write_record(self, path: Path) -> None:
        """Write a record on a thread of its own, by the modelling of the session."""
        scene, modelling, look = self._session.scene, self._session.modelling, self._session.display
        self._job = Job(
            lambda report: _render(scene, modelling, look, path, report),
            self._simulator.call_later,
            progressed=lambda share: self._window.show_job(f"writing {path.name}", share),
            done=lambda _: self._end(f"saved {path}"),
            failed=self._end,
            name="record",
        )
        self._window.show_job(f"writing {path.name}", 0.0)
        self._job.start()

    def _end(self, sentence: str) -> None:
        self.close()
        self._window.show_job("", 0.0)
        self._window.say(sentence)

    def _try(self, save: Callable[[], None], path: Path) -> bool:
        """Write a file and say so, or why it was not written."""
        self._folder = str(path.parent)
        try:
            save()
        except OSError as error:
            self._window.say(in_one_sentence(error))
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


def _render(scene: Scene, modelling: Modelling, look: DisplayOptions, path: Path, report: Progress) -> None:
    """Write a record as ``insonify render`` does."""

    def track(blocks: Iterator[Any], pings: int, count: Callable[[Any], int]) -> Iterator[Any]:
        done = 0
        for block in blocks:
            yield block
            done += count(block)
            report(done / pings)

    forced = dict(modelling.forced)
    write(scene, path, look, tolerance=modelling.tolerance, forced=forced, track=track)
