"""Files that are dropped on a window."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QWidget

from insonify_viewer.errors.guarded_overrides import guard_override


def take_drops(window: QWidget, opened: Callable[[list[str]], None]) -> None:
    """Let a window take files that are dropped anywhere on it, and pass on their paths."""
    window.setAcceptDrops(True)
    window.installEventFilter(_Drops(window, opened))


class _Drops(QObject):
    """Takes the drops of a window, of which it is a child."""

    def __init__(self, window: QWidget, opened: Callable[[list[str]], None]) -> None:
        super().__init__(window)
        self._opened = opened

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Accept a drag with local files, and pass them on when they are dropped."""
        if event.type() not in (QEvent.Type.DragEnter, QEvent.Type.Drop):
            return False
        assert isinstance(event, QDragEnterEvent | QDropEvent)
        paths = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
        if not paths:
            return False
        event.acceptProposedAction()
        if event.type() is QEvent.Type.Drop:
            self._opened(paths)
        return True
