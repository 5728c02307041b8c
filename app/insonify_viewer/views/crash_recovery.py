"""Offers the scene of a window that ended without closing, and keeps the present one."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime

from PySide6.QtCore import QLockFile, QObject, QTimer
from PySide6.QtWidgets import QMessageBox

from insonify.scene import Scene
from insonify_viewer.errors.failure import Failure, format_trace
from insonify_viewer.recovery import INTERVAL, LeftScene, Recovery
from insonify_viewer.session import Session
from insonify_viewer.views.main_window import MainWindow


class CrashRecovery(QObject):
    """Writes the scene of a session every few seconds while it has unsaved changes.

    Parameters
    ----------
    window : MainWindow
        Its end, after the question about unsaved changes, removes the file.
    session : Session
        The scene.
    opened : callable
        Opens a scene (scene, file) in the window.
    """

    def __init__(self, window: MainWindow, session: Session, opened: Callable[[Scene, str], None]) -> None:
        super().__init__(window)
        self._window, self._session, self._opened = window, session, opened
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
            self._opened(left.scene, "")
            self._keep()  # before the other file goes
        left.path.unlink(missing_ok=True)

    def _wants(self, left: LeftScene) -> bool:
        changed = datetime.fromtimestamp(left.path.stat().st_mtime)
        question = (
            f"The viewer ended unexpectedly on {changed:%d %B at %H:%M}, with unsaved changes of the scene "
            f"“{left.scene.title}”. Open it as it was?"
        )
        title = "Unsaved changes were kept"
        return QMessageBox.question(self._window, title, question) == QMessageBox.StandardButton.Yes

    def _keep(self) -> None:
        try:
            self._recovery.keep(self._session.scene, unsaved=self._session.unsaved)
        except OSError as error:
            self._clock.stop()  # one sentence, not one every two seconds
            sentence = f"the scene cannot be kept against a crash ({error.strerror}); save it"
            self._window.complain(Failure(sentence, format_trace(error)))

    def _end(self) -> None:
        self._clock.stop()
        self._recovery.close()


def _make_lock(path: str) -> QLockFile:
    lock = QLockFile(path)
    lock.setStaleLockTime(0)  # it never grows old, it is left by a process that has ended
    return lock
