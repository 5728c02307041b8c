"""Keys of the three-dimensional view, while it has the keyboard."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QWidget

from insonify_viewer.errors.guarded_overrides import guard_override

STEP = 5.0  # degrees that a key turns the view
CLOSER = 1.1  # magnification by a key
TURNS: dict[int, tuple[float, float]] = {  # degrees across and up: the scene follows the arrow, as it follows the mouse
    Qt.Key.Key_Left: (-STEP, 0.0),
    Qt.Key.Key_Right: (STEP, 0.0),
    Qt.Key.Key_Up: (0.0, STEP),
    Qt.Key.Key_Down: (0.0, -STEP),
}
ZOOMS: dict[int, float] = {Qt.Key.Key_Plus: CLOSER, Qt.Key.Key_Minus: 1.0 / CLOSER}
OF_FOCUS = Qt.Key.Key_Tab, Qt.Key.Key_Backtab


class SeabedKeys(QObject):
    """Turns and zooms a view by keys, and leaves all others to the window.

    Elsewhere in the window + and − zoom the record.
    """

    def __init__(self, widget: QWidget, turn: Callable[[float, float], None], zoom: Callable[[float], None]) -> None:
        super().__init__(widget)
        self._turn, self._zoom = turn, zoom
        widget.installEventFilter(self)

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Act on the keys of the view before the shortcuts of the window do."""
        if not isinstance(event, QKeyEvent) or event.key() in OF_FOCUS:
            return False
        key = event.key()  # a letter of another alphabet has no name in Qt.Key
        others = event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
        event.setAccepted(key in (*TURNS, *ZOOMS) and not others)
        if event.isAccepted() and event.type() is QEvent.Type.KeyPress:
            if key in TURNS:
                self._turn(*TURNS[key])
            else:
                self._zoom(ZOOMS[key])
        return True
