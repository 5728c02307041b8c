"""Steps of arrow keys, the same in every view."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QKeyEvent

ARROWS: dict[int, tuple[int, int]] = {  # to the right and down
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
ENTER = Qt.Key.Key_Return, Qt.Key.Key_Enter
MANY = 10  # steps of an arrow key with Shift


def modifiers_of(event: QKeyEvent) -> Qt.KeyboardModifier:
    """Return which keys such as Shift are held with a key, wherever on the keyboard it lies."""
    return event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier


def steps_of(event: QKeyEvent) -> tuple[int, int] | None:
    """Return the steps to the right and down that a key asks for, ten with Shift; None for all but arrow keys."""
    count = {Qt.KeyboardModifier.NoModifier: 1, Qt.KeyboardModifier.ShiftModifier: MANY}.get(modifiers_of(event))
    if count is None or event.key() not in ARROWS:
        return None
    across, down = ARROWS[event.key()]
    return count * across, count * down
