"""Rulers of the record: range below it, pings beside it."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QPainter

from insonify.display.range_axis import NAMES
from insonify_viewer.record.projection import Projection
from insonify_viewer.widgets.pixels import round_steps
from insonify_viewer.widgets.theme import EDGE, QUIET, TEXT


def draw_range_ruler(painter: QPainter, plot: QRect, projection: Projection, scale: str, text: float) -> None:
    """Draw metres of range from nadir to both sides."""
    base = plot.bottom() + 1
    for value, x in range_ticks(plot, projection, text):
        painter.setPen(QColor(EDGE))
        painter.drawLine(x, base, x, base + 5)
        painter.setPen(QColor(QUIET))
        place = _lines(x - round(40 * text), base + 6, round(80 * text), text)
        painter.drawText(place, Qt.AlignmentFlag.AlignHCenter, f"{abs(value):g}")
    painter.setPen(QColor(QUIET))
    beyond = round(24 * text)  # the margins hold what is longer than the record is wide
    line = _lines(plot.left() - beyond, base + round(20 * text), plot.width() + 2 * beyond, text)
    name = f"{NAMES[projection.axis.kind]} (m)"
    whole = f"{name}  ·  {scale}"
    fits = painter.fontMetrics().horizontalAdvance(whole) <= line.width()
    painter.drawText(line, Qt.AlignmentFlag.AlignHCenter, whole if fits else name)
    painter.setPen(QColor(TEXT))
    line = _lines(plot.left(), plot.top() - round(20 * text), plot.width(), text)
    first, last = projection.shown
    if first < 0.0:
        painter.drawText(line, Qt.AlignmentFlag.AlignLeft, "port")
    if last > 0.0:
        painter.drawText(line, Qt.AlignmentFlag.AlignRight, "starboard")


def range_ticks(plot: QRect, projection: Projection, text: float) -> list[tuple[float, int]]:
    """Round distances from nadir within a plot, negative to port, with their places in pixels."""
    values = round_steps(*projection.shown, max(int(plot.width() / (65 * text)), 1))
    return [(value, plot.left() + int(float(projection.across(np.array(value))) * plot.width())) for value in values]


def draw_ping_ruler(painter: QPainter, area: QRect, projection: Projection, step: float, text: float) -> None:
    """Draw ping numbers, each with the metres towed."""
    right, width = area.right() + 1, area.width() - 9
    newest, oldest = sorted(projection.ages)
    steps = round_steps(0.0, oldest - newest, max(int(area.height() / (70 * text)), 1))
    apart = max(int(steps[1]), 1) if len(steps) > 1 else max(int(oldest - newest), 1)
    first, last = math.floor(projection.newest - oldest) + 1, math.floor(projection.newest - newest)
    for ping in range(max(first, 0) // apart * apart, last + 1, apart):
        y = area.top() + int(float(projection.down(np.array(ping - 0.5))) * area.height())
        if not area.top() + 8 <= y <= area.bottom():
            continue
        painter.setPen(QColor(EDGE))
        painter.drawLine(right - 5, y, right - 1, y)
        painter.setPen(QColor(TEXT))
        painter.drawText(_lines(area.left(), y - round(13 * text), width, text), Qt.AlignmentFlag.AlignRight, f"{ping}")
        towed = _lines(area.left(), y, width, text)
        if towed.bottom() <= area.bottom() + 6:  # lower, the range ruler begins
            painter.setPen(QColor(QUIET))
            painter.drawText(towed, Qt.AlignmentFlag.AlignRight, write_towed(ping * step, apart * step))
    painter.setPen(QColor(QUIET))
    place = _lines(area.left(), area.top() - round(20 * text), width, text)
    painter.drawText(place, Qt.AlignmentFlag.AlignRight, "ping")


def write_towed(metres: float, apart: float) -> str:
    """Metres towed, to tenths unless the numbers are nearer to each other."""
    return f"{round(metres, 1 if apart >= 0.2 else 3):g} m"


def _lines(left: int, top: int, width: int, text: float) -> QRect:
    """Room for one line of text by a factor larger than usual."""
    return QRect(left, top, width, round(16 * text))
