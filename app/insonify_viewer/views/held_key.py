"""A key that acts while it is held."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QWidget

from insonify_viewer.errors.guarded_overrides import guard_override


class HeldKey(QObject):
    """Tells when a key without modifiers is pressed in a window and when it is let go.

    Parameters
    ----------
    window : QWidget
        Window in which the key works, wherever no widget takes it as text.
    key : Key
        The key.
    held : callable
        Receives True when the key is pressed, False when it is let go or the window loses the keyboard.
    """

    def __init__(self, window: QWidget, key: Qt.Key, held: Callable[[bool], None]) -> None:
        super().__init__(window)
        self._key, self._tell, self._held = key, held, False
        window.installEventFilter(self)

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Follow the key; repeats of a held key change nothing."""
        if event.type() is QEvent.Type.WindowDeactivate:
            self._set(False)
        if not isinstance(event, QKeyEvent) or event.key() != self._key:
            return False
        if event.type() is QEvent.Type.KeyRelease and not event.isAutoRepeat():
            self._set(False)
        elif event.type() is QEvent.Type.KeyPress and not event.modifiers():
            self._set(True)
        return False

    def _set(self, held: bool) -> None:
        if held != self._held:
            self._held = held
            self._tell(held)
