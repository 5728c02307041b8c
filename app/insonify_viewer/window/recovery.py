"""Recovery after a crash: unsaved scene and contacts are kept in files every few seconds."""

import contextlib
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import NamedTuple, TypeVar

from platformdirs import user_state_path
from PySide6.QtCore import QLockFile, QObject, QTimer
from PySide6.QtWidgets import QMessageBox

from insonify.io.atomic import write_text
from insonify.io.contacts import GEOJSON, Contact, describe_contacts, read_contacts, write_contacts
from insonify.scene import Scene, SceneError, load_scene, scene_to_toml
from insonify_viewer.errors import Failure, format_trace
from insonify_viewer.state.session import ContactList, Session
from insonify_viewer.widgets.text import literal
from insonify_viewer.window.main_window import MainWindow

Work = TypeVar("Work")
INTERVAL = 2.0  # s between looks at the work; no more of it is lost, and the time of writing
PREFIX = "unsaved-"
SCENE, LOCK = ".toml", ".lock"
MOST_CONTACTS = 5000  # of the last ones; they are written in 0.2 s
MOST_PICTURES = 4_000_000  # bytes, of the last contacts; the contacts before them are kept without their pictures


class LeftWork(NamedTuple):
    """What a window left behind when it ended without closing."""

    scene: Scene | None  # as it was last edited; None if it had no unsaved changes
    contacts: tuple[Contact, ...]  # empty if they had no unsaved changes
    changed: float  # when they were last written, in seconds since 1970
    stem: Path  # their files without suffix

    def remove(self) -> None:
        """Remove the files."""
        for suffix in (SCENE, GEOJSON):
            self.stem.with_suffix(suffix).unlink(missing_ok=True)


class Recovery:
    """Writes the unsaved work of one window beside that of others."""

    def __init__(self) -> None:
        self._folder = user_state_path("insonify", appauthor=False) / "recovery"
        self._folder.mkdir(parents=True, exist_ok=True)
        self._stem = self._folder / f"{PREFIX}{os.getpid()}-{os.urandom(4).hex()}"
        self._lock = _make_lock(str(self._stem.with_suffix(LOCK)))
        self._lock.tryLock(0)
        self._scene: Scene | None = None
        self.contacts: tuple[Contact, ...] = ()

    def keep(self, scene: Scene | None, contacts: tuple[Contact, ...]) -> None:
        """Write scene and contacts with unsaved changes; of what has none, None or an empty tuple, no file is left."""
        if scene is not self._scene:
            file = self._stem.with_suffix(SCENE)
            if scene is None:
                file.unlink(missing_ok=True)
            else:
                write_text(file, scene_to_toml(scene))
            self._scene = scene
        if contacts is not self.contacts:
            file = self._stem.with_suffix(GEOJSON)
            if contacts:
                write_contacts(file, _bound(contacts))
            else:
                file.unlink(missing_ok=True)
            self.contacts = contacts

    def close(self) -> None:
        """Leave nothing behind: the window closes, after the question about unsaved changes."""
        self.keep(None, ())
        self._lock.unlock()

    def find_left(self) -> LeftWork | None:
        """Find the newest work that a process left which runs no more; files that cannot be read are removed."""
        left: LeftWork | None = None
        with contextlib.suppress(OSError):
            newest = sorted(self._folder.glob(f"{PREFIX}*"), key=lambda file: -file.stat().st_mtime)
            for stem in dict.fromkeys(file.with_suffix("") for file in newest):
                lock = _make_lock(str(stem.with_suffix(LOCK)))
                if stem == self._stem or not lock.tryLock(0):
                    continue
                lock.unlock()  # which removes its file, also that of a window without unsaved work
                left = left or _read_left(stem)
        return left


def _bound(contacts: Sequence[Contact]) -> list[Contact]:
    """Return the last contacts that are kept, and only the last of their pictures."""
    bounded: list[Contact] = []
    room = MOST_PICTURES
    for contact in reversed(contacts[-MOST_CONTACTS:]):
        room -= len(contact.snapshot)
        bounded.append(contact if room >= 0 else replace(contact, snapshot=b""))
    return bounded[::-1]


def _read_left(stem: Path) -> LeftWork | None:
    """Read the files of a window; None if none of them can be read."""
    files = [stem.with_suffix(suffix) for suffix in (SCENE, GEOJSON)]
    changed = max((file.stat().st_mtime for file in files if file.exists()), default=0.0)
    scene, contacts = _read(files[0], load_scene), _read(files[1], read_contacts)
    return LeftWork(scene, contacts or (), changed, stem) if scene or contacts else None


def _read(file: Path, read: Callable[[Path], Work]) -> Work | None:
    """Read a file if it is there; it is removed if it cannot be read."""
    if not file.exists():
        return None
    try:
        return read(file)
    except SceneError:
        file.unlink(missing_ok=True)
        return None


class CrashRecovery(QObject):
    """Writes scene and contacts of a session every few seconds while they have unsaved changes."""

    def __init__(
        self, window: MainWindow, session: Session, contacts: ContactList, opened: Callable[[Scene, str], None]
    ) -> None:
        super().__init__(window)
        self._window, self._session, self.contacts, self._opened = window, session, contacts, opened
        self._recovery = Recovery()
        self._clock = QTimer(self)
        self._clock.timeout.connect(self._keep)
        self._clock.start(int(1000 * INTERVAL))
        window.closing.connect(self._end)

    def offer(self) -> None:
        """Ask whether to open what was left, if something was."""
        left = self._recovery.find_left()
        if left is None:
            return
        if self._wants(left):
            if left.scene is not None:
                self._opened(left.scene, "")
            if left.contacts:
                self.contacts.open(left.contacts, "")
            self._keep()  # before the other files go
        left.remove()

    def _wants(self, left: LeftWork) -> bool:
        changed = datetime.fromtimestamp(left.changed)
        what = [] if left.scene is None else [f"the scene “{left.scene.title}”"]
        what += [describe_contacts(len(left.contacts))] if left.contacts else []
        question = (
            f"The viewer ended unexpectedly on {changed:%d %B at %H:%M}, with unsaved changes of {' and '.join(what)}. "
            f"Open {'it as it was' if len(what) == 1 else 'them as they were'}?"
        )
        title = "Unsaved changes were kept"
        return QMessageBox.question(self._window, title, literal(question)) == QMessageBox.StandardButton.Yes

    def _keep(self) -> None:
        session, contacts = self._session, self.contacts
        try:
            self._recovery.keep(session.scene if session.unsaved else None, contacts.all if contacts.unsaved else ())
        except OSError as error:
            self._clock.stop()  # one sentence, not one every two seconds
            sentence = f"scene and contacts cannot be backed up against a crash ({error.strerror}); save them"
            self._window.complain(Failure(sentence, format_trace(error)))

    def _end(self) -> None:
        self._clock.stop()
        self._recovery.close()


def _make_lock(path: str) -> QLockFile:
    lock = QLockFile(path)
    lock.setStaleLockTime(0)  # it never expires; a process that has ended leaves it
    return lock
