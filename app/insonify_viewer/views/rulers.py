"""Rulers of the record: slant range below it, pings beside it."""

from __future__ import annotations

from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QPainter

from insonify_viewer.views.pixels import round_steps
from insonify_viewer.views.theme import EDGE, QUIET, TEXT


def draw_slant_ruler(painter: QPainter, plot: QRect, slant_range: float, scale: str) -> None:
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
    """
    middle, base = plot.left() + plot.width() / 2.0, plot.bottom() + 1
    for value in round_steps(0.0, slant_range, max(plot.width() // 130, 1)):
        away = value / slant_range * plot.width() / 2.0
        for x in {middle - away, middle + away}:
            painter.setPen(QColor(EDGE))
            painter.drawLine(int(x), base, int(x), base + 5)
            painter.setPen(QColor(QUIET))
            painter.drawText(QRect(int(x) - 40, base + 6, 80, 14), Qt.AlignmentFlag.AlignHCenter, f"{value:g}")
    painter.setPen(QColor(QUIET))
    line = QRect(plot.left(), base + 20, plot.width(), 16)
    painter.drawText(line, Qt.AlignmentFlag.AlignHCenter, f"slant range (m)  ·  {scale}")
    painter.setPen(QColor(TEXT))
    line = QRect(plot.left(), plot.top() - 20, plot.width(), 16)
    painter.drawText(line, Qt.AlignmentFlag.AlignLeft, "port")
    painter.drawText(line, Qt.AlignmentFlag.AlignRight, "starboard")


def draw_ping_ruler(painter: QPainter, area: QRect, top: int, pings: int, step: float) -> None:
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
    """
    right, width = area.right() + 1, area.width() - 9
    steps = round_steps(0.0, pings, max(area.height() // 70, 1))
    apart = max(int(steps[1]), 1) if len(steps) > 1 else pings
    for ping in range(max(top - pings + 1, 0) // apart * apart, top + 1, apart):
        y = area.top() + int((top - ping + 0.5) / pings * area.height())
        if not area.top() + 8 <= y <= area.bottom():
            continue
        painter.setPen(QColor(EDGE))
        painter.drawLine(right - 5, y, right - 1, y)
        painter.setPen(QColor(TEXT))
        painter.drawText(QRect(area.left(), y - 13, width, 14), Qt.AlignmentFlag.AlignRight, f"{ping}")
        painter.setPen(QColor(QUIET))
        painter.drawText(QRect(area.left(), y, width, 14), Qt.AlignmentFlag.AlignRight, f"{ping * step:.4g} m")
    painter.setPen(QColor(QUIET))
    painter.drawText(QRect(area.left(), area.top() - 20, width, 16), Qt.AlignmentFlag.AlignRight, "ping")
