"""What is painted over a record: lines of range and of the bed, the cross, measured lines, contacts, scroll bars."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QPolygonF

from insonify_viewer.record.projection import Projection
from insonify_viewer.record.rulers import range_ticks
from insonify_viewer.widgets.theme import EDGE, HALO, MARK_IN_WATER, QUIET, RAISED, TEXT

BAR = 5  # px, thickness of the bar that shows which part of the range is seen
LEAST_BAR = 24.0  # px
MOST_POINTS = 200  # of the bottom line
LINE = QColor(255, 255, 255, 70)  # of equal range
BED = "#ffb000"  # distinct from the palettes' middle tones
CONTACT = "#7dff5a"


def draw_range_lines(painter: QPainter, plot: QRect, projection: Projection, text: float) -> None:
    """Draw lines of equal range at the ticks of the ruler."""
    painter.setPen(LINE)
    for _, x in range_ticks(plot, projection, text):
        painter.drawLine(x, plot.top(), x, plot.bottom())


def draw_bottom_line(painter: QPainter, plot: QRect, projection: Projection) -> None:
    """Draw the slant range of the bed beneath the sonar on both sides."""
    upper, lower = projection.ages
    count = min(plot.height(), MOST_POINTS)
    apart = plot.height() / count
    ages = np.linspace(upper, lower, count, endpoint=False)
    pings = (projection.newest - np.floor(ages)).astype(np.int64)
    altitude = projection.altitude_of(np.maximum(pings, 0))
    known = np.flatnonzero((altitude > 0.0) & (pings >= 0))
    distance = projection.axis.distance_of(altitude / projection.axis.bin_length * (1.0 + 1e-12), altitude)
    painter.setPen(QPen(QColor(BED), 1.2))
    for sign in (-1.0, 1.0):
        x = plot.left() + projection.across(sign * distance) * plot.width()
        inside = known[(x[known] >= plot.left()) & (x[known] <= plot.right())]
        for run in np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1):
            painter.drawPolyline(QPolygonF([QPointF(x[k], plot.top() + (k + 0.5) * apart) for k in run]))


def draw_cross(painter: QPainter, place: QPoint) -> None:
    """Draw a cross about the point under the mouse."""
    for colour, width in ((HALO, 4), (MARK_IN_WATER, 2)):
        painter.setPen(QPen(QColor(colour), width))
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            painter.drawLine(place + QPoint(5 * dx, 5 * dy), place + QPoint(14 * dx, 14 * dy))


def draw_measured(painter: QPainter, plot: QRect, ends: tuple[QPoint, QPoint], words: str) -> None:
    """Draw a measured line with its length in words, inside the plot."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for colour, width in ((HALO, 4.0), (MARK_IN_WATER, 2.0)):
        painter.setPen(QPen(QColor(colour), width))
        painter.drawLine(*ends)
        for end in ends:
            painter.drawEllipse(QPointF(end), 3.0, 3.0)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    wrapped = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
    size = painter.fontMetrics().boundingRect(QRect(0, 0, plot.width() - 20, plot.height()), wrapped, words)
    box = QRect(0, 0, size.width() + 14, size.height() + 8)
    box.moveCenter((ends[0] + ends[1]) / 2 + QPoint(0, 14 + box.height() // 2))
    box.moveLeft(min(max(box.left(), plot.left() + 2), max(plot.right() - box.width() - 2, plot.left())))
    box.moveTop(min(max(box.top(), plot.top() + 2), max(plot.bottom() - box.height() - 2, plot.top())))
    painter.setPen(QColor(EDGE))
    painter.setBrush(QColor(RAISED))
    painter.drawRoundedRect(box, 4.0, 4.0)
    painter.setPen(QColor(TEXT))
    painter.drawText(box.adjusted(6, 4, -6, -4), wrapped, words)


def draw_contacts(painter: QPainter, plot: QRect, contacts: Iterable[tuple[QPoint, str, bool]]) -> None:
    """Draw contacts as corners about their places, with their names; a chosen one is drawn stronger."""
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for place, name, chosen in contacts:
        if not plot.contains(place):
            continue
        for colour, width in ((HALO, 4.0), (CONTACT, 2.5 if chosen else 1.5)):
            painter.setPen(QPen(QColor(colour), width))
            for dx, dy in ((-1, -1), (1, -1), (-1, 1), (1, 1)):
                corner = place + QPoint(9 * dx, 9 * dy)
                painter.drawPolyline([corner - QPoint(5 * dx, 0), corner, corner - QPoint(0, 5 * dy)])
        right = place.x() + 14 + painter.fontMetrics().horizontalAdvance(name) <= plot.right()
        x = place.x() + 14 if right else place.x() - 14 - painter.fontMetrics().horizontalAdvance(name)
        painter.setPen(QColor(HALO))
        painter.drawText(x + 1, place.y() + 5, name)
        painter.setPen(QColor(CONTACT))
        painter.drawText(x, place.y() + 4, name)


def draw_range_bar(painter: QPainter, plot: QRect, projection: Projection) -> None:
    """Draw which part of the range, and which of the pings held, a zoomed record shows."""
    zoom = projection.zoom
    if zoom.whole:
        return
    painter.setPen(Qt.PenStyle.NoPen)
    for horizontal, first, last in ((True, zoom.left, zoom.right), (False, zoom.upper, zoom.lower)):
        if (first, last) == (0.0, 1.0):
            continue
        length = plot.width() if horizontal else plot.height()
        long = max((last - first) * length, LEAST_BAR)
        start = first / max(1.0 - last + first, 1e-9) * (length - long)
        for colour, at, size in ((QColor(RAISED), 0.0, float(length)), (QColor(QUIET), start, long)):
            painter.setBrush(colour)
            if horizontal:
                painter.drawRect(QRectF(plot.left() + at, plot.bottom() + 1 - BAR, size, BAR))
            else:
                painter.drawRect(QRectF(plot.right() + 1 - BAR, plot.top() + at, BAR, size))
