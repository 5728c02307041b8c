"""Commands that compare two records, and the key that shows record A while it is pressed."""

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QEvent, QObject, Qt, Signal
from PySide6.QtGui import QAction, QKeyEvent
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

from insonify_viewer.errors import guard_override
from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.widgets.buttons import make_action

TEXTS = QLineEdit, QAbstractSpinBox, QTextEdit, QPlainTextEdit  # in which the key is a letter


class ComparisonActions(QObject):
    """Actions that keep a record as A, show it, and return to it."""

    toggled = Signal(object)  # Arrangement to turn to, or to leave if it is shown
    held = Signal(bool)  # whether A is to be shown in the place of B

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.actions: list[QAction] = []
        self.keep = self._action(window, "Keep as A", "Keep this record as A, to compare others with it", "K")
        self.partner = self._action(window, "Partner as A", "Simulate the other scene of the pair as A", "P")
        self.back = self._action(window, "Return to A", "Go back to the scene of A; Undo reverses it", "Shift+K")
        for text, tip, key, arrangement in (
            ("Wipe A and B", "A left of a line that is dragged, B right of it", "W", Arrangement.WIPED),
            ("Difference of A and B", "Level of B over A, in dB", "D", Arrangement.DIFFERENCE),
        ):
            self._action(window, text, tip, key, partial(self.toggled.emit, arrangement))
        HeldKey(window, Qt.Key.Key_X, self.held.emit)

    def _action(
        self, window: QWidget, text: str, tip: str, key: str, do: Callable[[], object] | None = None
    ) -> QAction:
        action = make_action(window, text, tip, key, do)
        window.addAction(action)
        self.actions.append(action)
        return action


class HeldKey(QObject):
    """Signals when a key without modifiers is pressed in a window and when it is released."""

    # Lists and combo boxes would look for an entry with that letter, so the key is taken before the widget that has
    # the keyboard receives it.

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
        typed = isinstance(watched, TEXTS) or (isinstance(watched, QComboBox) and watched.isEditable())
        if event.type() is QEvent.Type.KeyPress and not event.modifiers() and not typed:
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
