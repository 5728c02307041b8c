"""Offers the work of a window that ended without closing, and keeps that of the present one."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime

from PySide6.QtCore import QLockFile, QObject, QTimer
from PySide6.QtWidgets import QMessageBox

from insonify.scene import Scene
from insonify_viewer.errors.failure import Failure, format_trace
from insonify_viewer.state.contacts import ContactList, describe_contacts
from insonify_viewer.state.session import Session
from insonify_viewer.window.main_window import MainWindow
from insonify_viewer.window.recovery import INTERVAL, LeftWork, Recovery


class CrashRecovery(QObject):
    """Writes scene and contacts of a session every few seconds while they have unsaved changes."""

    def __init__(
        self, window: MainWindow, session: Session, contacts: ContactList, opened: Callable[[Scene, str], None]
    ) -> None:
        super().__init__(window)
        self._window, self._session, self._contacts, self._opened = window, session, contacts, opened
        self._recovery = Recovery(_make_lock)
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
                self._contacts.open(left.contacts, "")
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
        return QMessageBox.question(self._window, title, question) == QMessageBox.StandardButton.Yes

    def _keep(self) -> None:
        session, contacts = self._session, self._contacts
        try:
            self._recovery.keep(session.scene if session.unsaved else None, contacts.all if contacts.unsaved else ())
        except OSError as error:
            self._clock.stop()  # one sentence, not one every two seconds
            sentence = f"scene and contacts cannot be kept against a crash ({error.strerror}); save them"
            self._window.complain(Failure(sentence, format_trace(error)))

    def _end(self) -> None:
        self._clock.stop()
        self._recovery.close()


def _make_lock(path: str) -> QLockFile:
    lock = QLockFile(path)
    lock.setStaleLockTime(0)  # it never grows old, it is left by a process that has ended
    return lock
