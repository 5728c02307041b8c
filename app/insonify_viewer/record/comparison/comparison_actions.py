"""Keys of the window that compare two records."""

from __future__ import annotations

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QWidget

from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.widgets.held_key import HeldKey


class ComparisonActions(QObject):
    """Actions that keep a record as A, show it, and return to it."""

    toggled = Signal(object)  # Arrangement to turn to, or to leave if it is shown
    held = Signal(bool)  # whether A is to be shown in the place of B

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.actions: list[QAction] = []
        self.keep = self._action(window, "Keep as A", "Keep this record as A, to compare others with it", "K")
        self.partner = self._action(window, "Partner as A", "Trace the partner that the scene names, as A", "P")
        self.back = self._action(window, "Return to A", "Return to the scene of A; undo comes back", "Shift+K")
        for text, tip, key, arrangement in (
            ("Wipe A and B", "A left of a line that is dragged, B right of it", "W", Arrangement.WIPED),
            ("Difference of A and B", "Level of B over A, in dB", "D", Arrangement.DIFFERENCE),
        ):
            action = self._action(window, text, tip, key)
            action.triggered.connect(lambda _=False, arrangement=arrangement: self.toggled.emit(arrangement))
        HeldKey(window, Qt.Key.Key_X, self.held.emit)

    def _action(self, window: QWidget, text: str, tip: str, key: str) -> QAction:
        action = QAction(text, window)
        action.setToolTip(f"{tip} ({key})")
        action.setShortcut(QKeySequence(key))
        window.addAction(action)
        self.actions.append(action)
        return action
