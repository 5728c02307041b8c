"""Handles of targets over a record: drawn near the mouse, which drags them."""

from collections.abc import Callable, Sequence

import numpy as np
from PySide6.QtCore import QObject, QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPen

from insonify.arrays import Booleans, Integers
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

    def __init__(self, places_of: Callable[[Integers], Integers], changed: Callable[[], None], parent: QObject) -> None:
        super().__init__(parent)
        self._places_of, self._changed = places_of, changed
        self.shown: Sequence[Shown] = ()
        self._marks, self._chosen = np.zeros((0, 3), np.int64), np.zeros(0, np.bool_)
        self._mouse = QPoint(-1000, -1000)
        self.held = False

    def show(self, handles: Sequence[Shown]) -> None:
        """Show handles: number, bin, what a drag does, and whether it belongs to the chosen target."""
        if handles != self.shown:
            self.shown = handles
            marks = [(mark.ping, mark.side, mark.bin) for _, mark, _, _ in handles]
            self._marks = np.array(marks, np.int64).reshape(-1, 3)
            self._chosen = np.array([chosen for *_, chosen in handles], np.bool_)
            self._changed()

    def place(self, number: int) -> QPoint:
        """Position of a handle in the view."""
        place = next(place for place, (shown, *_) in enumerate(self.shown) if shown == number)
        return QPoint(*self._places_of(self._marks[place : place + 1])[0].tolist())

    def take(self, place: QPoint, mark: Mark | None) -> bool:
        """Take hold of the handle at a place; return whether there is one."""
        handle = self._at(place, self._places_of(self._marks))
        if handle is None:
            return False
        self.held = True
        self.taken.emit(handle[0])
        if mark is not None:
            self.pulled.emit(mark)
        return True

    def release(self) -> None:
        """Let go of the handle."""
        self.held = False
        self.released.emit()

    def hover(self, place: QPoint) -> str:
        """Follow the mouse; return what a drag from here would do, or nothing."""
        places = self._places_of(self._marks)
        before, self._mouse = self._visible(places), place
        if (self._visible(places) != before).any():
            self._changed()
        handle = self._at(place, places)
        return "" if handle is None else TIPS[handle[2]]

    def draw(self, painter: QPainter) -> None:
        """Draw the handles of the chosen target, and those near the mouse."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        places = self._places_of(self._marks)
        for k in np.flatnonzero(self._visible(places)).tolist():
            _, _, action, chosen = self.shown[k]
            _draw(painter, QPointF(*places[k].tolist()), action, chosen=chosen)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)

    def _visible(self, places: Integers) -> Booleans:
        return self._chosen | (_distances(places, self._mouse) <= SEEN)

    def _at(self, place: QPoint, places: Integers) -> Shown | None:
        """Return the nearest handle within reach of the mouse; ends before middles, which move the whole."""
        distance = _distances(places, place)
        within = np.flatnonzero(distance <= GRIP).tolist()
        ranks = [(self.shown[k][2] == "move", int(distance[k]), self.shown[k][0], k) for k in within]
        return self.shown[min(ranks)[-1]] if ranks else None


def _distances(places: Integers, place: QPoint) -> Integers:
    """Distances of places from one, along and across together, in pixels."""
    return np.asarray(np.abs(places - (place.x(), place.y())).sum(axis=1))


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
