"""A thin bar over a picture that waits, with what it waits for."""

from __future__ import annotations

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QBrush, QColor, QPainter

from insonify_viewer.widgets.theme import ACCENT, EDGE, GROUND, TEXT
from insonify_viewer.work.waiting import Waiting

THIN, HIGH = 4, 24  # px, of the bar and of its text


def draw_waiting(painter: QPainter, plot: QRect, waiting: Waiting) -> None:
    """Draw a bar along the upper edge of a plot; a bar of unknown length is hatched."""
    strip = QRect(plot.left(), plot.top(), plot.width(), THIN + HIGH)
    ground = QColor(GROUND)
    ground.setAlpha(215)
    painter.fillRect(strip, ground)
    bar = QRect(strip.left(), strip.top(), strip.width(), THIN)
    painter.fillRect(bar, QColor(EDGE))
    if waiting.share is None:
        painter.fillRect(bar, QBrush(QColor(ACCENT), Qt.BrushStyle.BDiagPattern))
    else:
        bar.setWidth(round(min(max(waiting.share, 0.0), 1.0) * bar.width()))
        painter.fillRect(bar, QColor(ACCENT))
    painter.setPen(QColor(TEXT))
    text = strip.adjusted(8, THIN, -8, 0)
    words = painter.fontMetrics().elidedText(waiting.what, Qt.TextElideMode.ElideRight, text.width())
    painter.drawText(text, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, words)
