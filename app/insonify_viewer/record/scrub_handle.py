"""A handle beside the record that moves it to any ping of the tow."""

from __future__ import annotations

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter

from insonify_viewer.widgets.theme import ACCENT, EDGE, GROUND, QUIET, RAISED, TEXT

WIDTH, HEIGHT, ROUND = 10.0, 26.0, 4.0  # px
LABEL = 92.0  # px, of the ping beside a held handle


class ScrubHandle:
    """Geometry and painting of the handle, with the last ping on top or below as in the record."""

    def __init__(self) -> None:
        self.last = 1
        self.held = False
        self.newest_on_top = True
        self._rail = QRectF()

    def lay(self, left: float, top: float, height: float) -> None:
        """Place the rail."""
        self._rail = QRectF(left, top, WIDTH, height)

    def contains(self, place: QPointF) -> bool:
        """Whether a place lies on the rail, or beside it within a few pixels."""
        return self._rail.adjusted(-4.0, 0.0, 4.0, 0.0).contains(place)

    def ping_at(self, place: QPointF) -> int:
        """Ping at a height of the rail."""
        share = (place.y() - self._rail.top() - HEIGHT / 2.0) / max(self._rail.height() - HEIGHT, 1.0)
        share = min(max(share, 0.0), 1.0)
        return round((1.0 - share if self.newest_on_top else share) * self.last)

    def place_of(self, ping: int) -> QPointF:
        """Middle of the handle for a ping on top of the record."""
        share = min(max(ping / max(self.last, 1), 0.0), 1.0)
        share = 1.0 - share if self.newest_on_top else share
        middle = self._rail.top() + HEIGHT / 2.0 + share * (self._rail.height() - HEIGHT)
        return QPointF(self._rail.center().x(), middle)

    def draw(self, painter: QPainter, ping: int) -> None:
        """Draw rail and handle, with the ping while it is held."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(RAISED))
        painter.drawRoundedRect(self._rail, ROUND, ROUND)
        middle = self.place_of(ping)
        handle = QRectF(self._rail.left(), middle.y() - HEIGHT / 2.0, WIDTH, HEIGHT)
        painter.setBrush(QColor(ACCENT if self.held else QUIET))
        painter.drawRoundedRect(handle, ROUND, ROUND)
        painter.setPen(QColor(GROUND))
        for step in (-3.0, 0.0, 3.0):
            y = middle.y() + step
            painter.drawLine(QPointF(handle.left() + 3.0, y), QPointF(handle.right() - 3.0, y))
        if self.held:
            self._draw_ping(painter, handle, ping)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)

    def _draw_ping(self, painter: QPainter, handle: QRectF, ping: int) -> None:
        box = QRectF(handle.left() - LABEL - 6.0, handle.top() + 3.0, LABEL, HEIGHT - 6.0)
        painter.setPen(QColor(EDGE))
        painter.setBrush(QColor(RAISED))
        painter.drawRoundedRect(box, ROUND, ROUND)
        painter.setPen(QColor(TEXT))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, f"ping {ping}")
