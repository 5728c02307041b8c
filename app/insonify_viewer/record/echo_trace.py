"""Echo of one ping over slant range, drawn under the record and aligned with it."""

# It is painted with the record, column for column and at every move of the mouse, from the first picture on: before
# pyqtgraph is loaded.

import math

import numpy as np
from PySide6.QtCore import QPointF, QRect, Qt
from PySide6.QtGui import QColor, QPainter, QPen

from insonify.arrays import Singles
from insonify_viewer.widgets.painting import make_polyline
from insonify_viewer.widgets.theme import ACCENT, EDGE, MARK, QUIET, RAISED

SHARE, GAP = 5, 22  # parts of a view that trace and gap have one of; px between the trace and the ruler above it
CAPTION, WIDE = 16, 150  # px, of the words that are clicked to show or hide it
LOW, ROOMY = 400, 520  # px, heights of a view from which a trace can be drawn, and from which it is unless asked for
FLOOR, STEP = -30.0, 10.0  # dB re level bed: lowest of the scale, and its lines


def room_for_trace(height: int) -> int:
    """Height in px to keep free for the trace in a view; 0 where it is too low."""
    return height // SHARE if height >= LOW else 0


def draw_trace(painter: QPainter, area: QRect, loudest: Singles, title: str, at: float | None) -> None:
    """Draw the trace of one ping."""
    with np.errstate(divide="ignore"):
        levels = 20.0 * np.log10(np.nan_to_num(loudest.astype(np.float64)))
    top = max(STEP * math.ceil(float(levels.max(initial=0.0)) / STEP), STEP)
    painter.fillRect(area, QColor(RAISED))
    painter.save()
    painter.setClipRect(area)
    painter.setPen(QColor(EDGE))
    for _, y in _scale(area, top):
        painter.drawLine(area.left(), round(y), area.right(), round(y))  # of whole pixels: crisp
    heights = area.bottom() - (np.maximum(levels, FLOOR) - FLOOR) / (top - FLOOR) * area.height()
    places = area.left() + 0.5 + np.arange(heights.size)
    line = make_polyline(places, heights)
    painter.setPen(QPen(QColor(ACCENT), 1.0))
    painter.drawPolyline(line)
    if at is not None:
        x = area.left() + at * area.width()
        painter.setPen(QPen(QColor(MARK), 1.0))
        painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))
    painter.restore()
    _draw_numbers(painter, area, top)
    draw_caption(painter, QRect(area.left(), area.top() - CAPTION - 1, area.width(), CAPTION), f"▾ {title}")


def draw_caption(painter: QPainter, area: QRect, words: str) -> None:
    """Draw the words that are clicked to show or hide the trace."""
    painter.setPen(QColor(QUIET))
    where = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextDontClip  # in large type
    painter.drawText(area, where, words)


def _scale(area: QRect, top: float) -> list[tuple[float, float]]:
    """Levels in dB of the lines of the scale, with their heights in the area in px."""
    levels = np.arange(FLOOR + STEP, top, STEP).tolist()
    return [(level, area.bottom() - (level - FLOOR) / (top - FLOOR) * area.height()) for level in levels]


def _draw_numbers(painter: QPainter, area: QRect, top: float) -> None:
    """Write numbers beside the lines where there is room, left of the curve."""
    lines = _scale(area, top)
    high = painter.fontMetrics().height()
    painter.setPen(QColor(QUIET))
    for level, y in lines:
        if level % (2.0 * STEP) == 0.0 or area.height() > 30 * len(lines):
            words = f"{level:+g} dB".replace("-", "−") if level else "bed"
            place = QRect(0, round(y) - high // 2, area.left() - 9, high)
            painter.drawText(place, Qt.AlignmentFlag.AlignRight | Qt.TextFlag.TextDontClip, words)
