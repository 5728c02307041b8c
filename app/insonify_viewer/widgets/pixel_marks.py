"""Painting of the pinned pixel, and of the pixels that hear a place."""

from __future__ import annotations

from collections.abc import Iterable

from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from insonify_viewer.widgets.theme import HALO, MARK_IN_WATER

RING, DOT = 7.0, 3.0  # px
LIT = "#ff5fd2"  # distinct from the mark and from every palette


def draw_pin(painter: QPainter, place: QPoint) -> None:
    """Draw a ring about the pinned pixel."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    centre = QPointF(place)
    for colour, width in ((HALO, 5.0), (MARK_IN_WATER, 2.5)):
        painter.setPen(QPen(QColor(colour), width))
        painter.drawEllipse(centre, RING, RING)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)


def draw_lit(painter: QPainter, places: Iterable[QPoint]) -> None:
    """Draw the pixels that hear a place."""
    painter.setPen(QColor(HALO))
    painter.setBrush(QColor(LIT))
    for place in places:
        painter.drawRect(QRectF(place.x() - DOT, place.y() - DOT, 2.0 * DOT, 2.0 * DOT))
