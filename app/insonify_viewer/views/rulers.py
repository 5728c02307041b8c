"""Rulers of the record: slant range below it, pings beside it."""

from __future__ import annotations

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QPainter

from insonify_viewer.views.pixels import round_steps
from insonify_viewer.views.theme import EDGE, QUIET, TEXT


def draw_slant_ruler(painter: QPainter, plot: QRect, slant_range: float, scale: str, text: float) -> None:
    """Draw metres of slant range from nadir to both sides.

    Parameters
    ----------
    painter : QPainter
    plot : QRect
        The record.
    slant_range : float
        At its ends, m.
    scale : str
        Whether the record is at true scale.
    text : float
        Factor on the usual size of the text.
    """
    middle, base = plot.left() + plot.width() / 2.0, plot.bottom() + 1
    for value in round_steps(0.0, slant_range, max(int(plot.width() / (130 * text)), 1)):
        away = value / slant_range * plot.width() / 2.0
        for x in {middle - away, middle + away}:
            painter.setPen(QColor(EDGE))
            painter.drawLine(int(x), base, int(x), base + 5)
            painter.setPen(QColor(QUIET))
            place = _lines(int(x) - round(40 * text), base + 6, round(80 * text), text)
            painter.drawText(place, Qt.AlignmentFlag.AlignHCenter, f"{value:g}")
    painter.setPen(QColor(QUIET))
    line = _lines(plot.left(), base + round(20 * text), plot.width(), text)
    painter.drawText(line, Qt.AlignmentFlag.AlignHCenter, f"slant range (m)  ·  {scale}")
    painter.setPen(QColor(TEXT))
    line = _lines(plot.left(), plot.top() - round(20 * text), plot.width(), text)
    painter.drawText(line, Qt.AlignmentFlag.AlignLeft, "port")
    painter.drawText(line, Qt.AlignmentFlag.AlignRight, "starboard")


def draw_ping_ruler(painter: QPainter, area: QRect, top: int, pings: int, step: float, text: float) -> None:
    """Draw ping numbers, each with the metres towed.

    Parameters
    ----------
    painter : QPainter
    area : QRect
        Beside the record, as high as it.
    top : int
        Ping on top.
    pings : int
        Pings that the record shows.
    step : float
        Metres between pings.
    text : float
        Factor on the usual size of the text.
    """
    right, width = area.right() + 1, area.width() - 9
    steps = round_steps(0.0, pings, max(int(area.height() / (70 * text)), 1))
    apart = max(int(steps[1]), 1) if len(steps) > 1 else pings
    for ping in range(max(top - pings + 1, 0) // apart * apart, top + 1, apart):
        y = area.top() + int((top - ping + 0.5) / pings * area.height())
        if not area.top() + 8 <= y <= area.bottom():
            continue
        painter.setPen(QColor(EDGE))
        painter.drawLine(right - 5, y, right - 1, y)
        painter.setPen(QColor(TEXT))
        painter.drawText(_lines(area.left(), y - round(13 * text), width, text), Qt.AlignmentFlag.AlignRight, f"{ping}")
        painter.setPen(QColor(QUIET))
        painter.drawText(_lines(area.left(), y, width, text), Qt.AlignmentFlag.AlignRight, f"{ping * step:.4g} m")
    painter.setPen(QColor(QUIET))
    place = _lines(area.left(), area.top() - round(20 * text), width, text)
    painter.drawText(place, Qt.AlignmentFlag.AlignRight, "ping")


def _lines(left: int, top: int, width: int, text: float) -> QRect:
    """Room for one line of text by a factor larger than usual."""
    return QRect(left, top, width, round(16 * text))
