"""A key that acts while it is held."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import (
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QLineEdit,
    QPlainTextEdit,
    QTextEdit,
    QWidget,
)
from shiboken6 import isValid

from insonify_viewer.errors.guarded_overrides import guard_override

TEXTS = QLineEdit, QAbstractSpinBox, QTextEdit, QPlainTextEdit  # in which the key is a letter


class HeldKey(QObject):
    """Tells when a key without modifiers is pressed in a window and when it is let go.

    Lists and combo boxes would look for an entry with that letter, so the key is taken before the widget that has the
    keyboard receives it.
    """

    def __init__(self, window: QWidget, key: Qt.Key, held: Callable[[bool], None]) -> None:
        super().__init__(window)
        self._window, self._key, self._tell, self._held = window, key, held, False
        self._focused: QWidget | None = None
        window.installEventFilter(self)
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusChanged.connect(self._follow)

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Follow the key; repeats of a held key change nothing."""
        if event.type() is QEvent.Type.WindowDeactivate and watched is self._window:
            self._set(False)
        if not isinstance(event, QKeyEvent) or event.key() != self._key:
            return False
        if event.type() is QEvent.Type.KeyRelease and not event.isAutoRepeat():
            self._set(False)
        elif event.type() is QEvent.Type.KeyPress and not event.modifiers() and not _takes_text(watched):
            self._set(True)
            return True
        return False

    def _follow(self, _left: QWidget | None, focused: QWidget | None) -> None:
        """Watch the widget of the window that has the keyboard, beside the window itself."""
        if self._focused is not None and isValid(self._focused):
            self._focused.removeEventFilter(self)
        inside = focused is not None and focused is not self._window and focused.window() is self._window
        self._focused = focused if inside else None
        if self._focused is not None:
            self._focused.installEventFilter(self)

    def _set(self, held: bool) -> None:
        if held != self._held:
            self._held = held
            self._tell(held)


def _takes_text(widget: QObject) -> bool:
    """Whether letters are typed into a widget."""
    return isinstance(widget, TEXTS) or (isinstance(widget, QComboBox) and widget.isEditable())
