"""Saves scene, record, picture and contacts, and asks before unsaved changes are lost."""

import re
from collections.abc import Callable, Mapping
from pathlib import Path

from insonify.io.atomic import write_text
from insonify.io.contact_reports import FORMATS as REPORTS
from insonify.io.contact_reports import write_report
from insonify.io.contacts import FORMATS, GEOJSON, describe_contacts, write_contacts
from insonify.operating_system import is_portable
from insonify.scene import SceneError, scene_to_toml
from insonify_viewer.state.session import ContactList, Session
from insonify_viewer.widgets.save_dialogs import (
    PICTURE,
    Answer,
    ask_about_changes,
    ask_about_jobs,
    ask_where_to_save,
    record_formats,
    save_picture,
)
from insonify_viewer.window.main_window import MainWindow
from insonify_viewer.work.jobs import JobList

SCENE = ".toml"
Savers = Mapping[str, Callable[[], bool]]  # what saves, by the name of what is not saved


class Saving:
    """Saves what the window shows."""

    def __init__(self, session: Session, contacts: ContactList, window: MainWindow, jobs: JobList) -> None:
        self._session, self._contacts, self._window, self._jobs = session, contacts, window, jobs
        self._folder = ""
        window.save.scene.triggered.connect(self.save_scene)
        window.save.scene_as.triggered.connect(self.save_scene_as)
        window.save.record.triggered.connect(self.save_record)
        window.save.picture.triggered.connect(self.save_window)

    @property
    def unsaved(self) -> bool:
        """Whether the scene or the contacts have unsaved changes."""
        return self._session.unsaved or self._contacts.unsaved

    def may_leave(self) -> bool:
        """Ask what becomes of unsaved changes of the scene; return whether it may be left. The contacts stay."""
        return self._may_lose(self._unsaved_scene())

    def may_replace_contacts(self) -> bool:
        """Ask what becomes of unsaved contacts; return whether others may take their place."""
        return self._may_lose(self._unsaved_contacts())

    def may_close(self) -> bool:
        """Ask once about all unsaved changes, and about jobs that run; return whether the window may be closed."""
        saved = self._may_lose({**self._unsaved_scene(), **self._unsaved_contacts()})
        return saved and (not self._jobs.running or ask_about_jobs(self._window, len(self._jobs.running)))

    def save_scene(self) -> bool:
        """Write the scene to its file, or to one that the person names; return whether it was written."""
        # A file with comments, which would be lost, is replaced only where the person says so.
        file = self._session.file
        return self._write_scene(Path(file)) if file and not _has_comments(file) else self.save_scene_as()

    def save_scene_as(self) -> bool:
        """Write the scene to a file that the person names; return whether it was written."""
        suggestion = self._session.file or self._suggest(SCENE)
        path = ask_where_to_save(self._window, "Save the scene", suggestion, [("Scenes", SCENE)])
        return path is not None and self._write_scene(path)

    def _write_scene(self, path: Path) -> bool:
        scene = self._session.scene
        if not self._try(lambda: write_text(path, scene_to_toml(scene)), path):
            return False
        self._session.mark_saved(str(path))
        self._window.settings.add_recent(str(path))
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

    def save_contacts(self) -> bool:
        """Write the contacts to a file that the person names, beside the scene at first; return whether they were."""
        suggestion = self._contacts.file or _beside(self._session.file)
        path = ask_where_to_save(self._window, "Save the contacts", suggestion, FORMATS)
        if path is None or not self._try(lambda: write_contacts(path, self._contacts.all), path):
            return False
        self._contacts.mark_saved(str(path))
        return True

    def report_contacts(self) -> None:
        """Write a report of the contacts to a file that the person names; they count as saved only in a list."""
        suggestion = str(Path(self._contacts.file or _beside(self._session.file)).with_suffix(REPORTS[0][1]))
        path = ask_where_to_save(self._window, "Save a report of the contacts", suggestion, REPORTS)
        if path is not None:
            self._try(lambda: write_report(path, self._contacts.all), path)

    def _unsaved_scene(self) -> Savers:
        return {f"the scene “{self._session.scene.title}”": self.save_scene} if self._session.unsaved else {}

    def _unsaved_contacts(self) -> Savers:
        return {describe_contacts(len(self._contacts)): self.save_contacts} if self._contacts.unsaved else {}

    def _may_lose(self, unsaved: Savers) -> bool:
        """Ask what becomes of unsaved changes; return whether they were saved or may be lost."""
        if not unsaved:
            return True
        answer = ask_about_changes(self._window, tuple(unsaved))
        return answer is Answer.DISCARD or (answer is Answer.SAVE and all(save() for save in unsaved.values()))

    def _try(self, save: Callable[[], None], path: Path) -> bool:
        """Write a file, and show that it was written or why it was not."""
        self._folder = str(path.parent)
        try:
            save()
        except (OSError, SceneError) as error:
            self._window.complain(error)
            return False
        self._window.say(f"saved {path}")
        return True

    def _suggest(self, suffix: str) -> str:
        """Suggest a file name by the title of the scene."""
        words = re.findall(r"[a-z0-9]+", self._session.scene.title.lower())
        name = "-".join(words[:6])
        return str(Path(self._folder, name if is_portable(name) else "scene").with_suffix(suffix))


def _has_comments(file: str) -> bool:
    """Whether a scene file has lines of comment."""
    try:
        return any(line.lstrip().startswith("#") for line in Path(file).read_text(encoding="utf-8").splitlines())
    except (OSError, UnicodeDecodeError):
        return False


def _beside(scene_file: str) -> str:
    """Name of the file of contacts beside that of a scene."""
    return str(Path(scene_file or "contacts").with_suffix(f".contacts{GEOJSON}" if scene_file else GEOJSON))
