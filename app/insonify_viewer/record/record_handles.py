"""Handles of targets over a record: drawn near the mouse, which drags them."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QObject, QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen

from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.theme import HALO, MARK_IN_WATER

GRIP = 9  # px from a handle at which the mouse takes hold of it
SEEN = 48  # px from the mouse within which the handles of targets that are not chosen are drawn
SIZE = 5.0  # px, half the size of a handle
TIPS = {
    "move": "Drag to move this target",
    "turn": "Drag to turn it",
    "resize": "Drag to resize it",
    "thicken": "Drag to thicken it",
    "raise": "Drag outwards to make it higher",
}
CORNERS = {
    "move": ((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)),
    "thicken": ((0.0, -1.1), (1.0, 0.8), (-1.0, 0.8)),
    "raise": ((-0.5, -1.3), (0.5, -1.3), (0.5, 1.1), (-0.5, 1.1)),
}
Shown = tuple[int, Mark, str, bool]


class RecordHandles(QObject):
    """Handles at bins of a record."""

    taken = Signal(int)  # number of a handle
    pulled = Signal(object)  # Mark under the mouse
    released = Signal()

    def __init__(self, place_of: Callable[[Mark], QPoint], changed: Callable[[], None], parent: QObject) -> None:
        super().__init__(parent)
        self._place_of, self._changed = place_of, changed
        self._shown: Sequence[Shown] = ()
        self._mouse = QPoint(-1000, -1000)
        self.held = False

    def show(self, handles: Sequence[Shown]) -> None:
        """Show handles: number, bin, what a drag does, and whether it belongs to the chosen target."""
        if handles != self._shown:
            self._shown = handles
            self._changed()

    def place(self, number: int) -> QPoint:
        """Position of a handle in the view."""
        return next(self._place_of(mark) for shown, mark, _, _ in self._shown if shown == number)

    def take(self, place: QPoint, mark: Mark | None) -> bool:
        """Take hold of the handle at a place; return whether there is one."""
        number = self._at(place)
        if number is None:
            return False
        self.held = True
        self.taken.emit(number)
        if mark is not None:
            self.pulled.emit(mark)
        return True

    def release(self) -> None:
        """Let go of the handle."""
        self.held = False
        self.released.emit()

    def hover(self, place: QPoint) -> str:
        """Follow the mouse; return what a drag from here would do, or nothing."""
        before, self._mouse = self._visible(), place
        if self._visible() != before:
            self._changed()
        number = self._at(place)
        return next((TIPS[action] for shown, _, action, _ in self._shown if shown == number), "")

    def draw(self, painter: QPainter) -> None:
        """Draw the handles of the chosen target, and those near the mouse."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for number, mark, action, chosen in self._shown:
            if number in self._visible():
                _draw(painter, QPointF(self._place_of(mark)), action, chosen=chosen)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)

    def _visible(self) -> set[int]:
        return {
            number
            for number, mark, _, chosen in self._shown
            if chosen or (self._place_of(mark) - self._mouse).manhattanLength() <= SEEN
        }

    def _at(self, place: QPoint) -> int | None:
        """Return the nearest handle within reach of the mouse; ends before middles, which move the whole."""
        near = [
            ((self._place_of(mark) - place).manhattanLength(), action == "move", number)
            for number, mark, action, _ in self._shown
        ]
        within = [(middle, distance, number) for distance, middle, number in near if distance <= GRIP]
        return min(within)[2] if within else None


def _draw(painter: QPainter, place: QPointF, action: str, *, chosen: bool) -> None:
    """Draw a handle: a diamond moves, a circle turns, a square resizes, a triangle thickens, a post raises."""
    for colour, width in ((HALO, 4.0), (MARK_IN_WATER, 2.0 if chosen else 1.2)):
        painter.setPen(QPen(QColor(colour), width))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if action == "turn":
            painter.drawEllipse(place, SIZE, SIZE)
        elif action == "resize":
            painter.drawRect(QRectF(place.x() - SIZE + 1, place.y() - SIZE + 1, 2 * SIZE - 2, 2 * SIZE - 2))
        else:
            painter.drawPolygon([place + QPointF(SIZE * dx, SIZE * dy) for dx, dy in CORNERS[action]])
