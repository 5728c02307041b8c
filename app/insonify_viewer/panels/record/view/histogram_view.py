"""Histogram of a record over its colour bar, whose ends are dragged."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QKeyEvent, QMouseEvent, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.record.tone_map import ToneMap
from insonify_viewer.widgets.theme import ACCENT, GROUND, QUIET, RAISED, TEXT

LOWEST, HIGHEST, STEP = -40.0, 40.0, 20.0  # dB re level bed
BAR, SCALE, MARGIN = 14, 16, 8  # px
GRIP = 9.0  # px beside an end in which it is taken hold of
APART = 0.5  # dB, least distance of the ends
KEY_STEP = 0.5  # dB


class HistogramView(QWidget):
    """Shows how often each level occurs, and the colours of the levels."""

    dragged = Signal(float, float)  # ends in dB re level bed; minus infinity for silence

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumHeight(104)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setAccessibleName("Contrast: levels of the record over the colour bar")
        self.setToolTip(
            "How often each level occurs. Drag the two ends of the colour bar; by keys, ← → move the upper end "
            "and Shift ← → the lower one."
        )
        self._counts: NDArray[np.float64] = np.zeros(1)
        self._due: Callable[[], NDArray[np.floating]] | None = None  # gives the levels to count
        self._bar = QImage()
        self._ends = (LOWEST, HIGHEST)
        self._held: int | None = None

    @guard_override(QSize())
    def sizeHint(self) -> QSize:
        """Size that is asked for."""
        return QSize(260, 112)

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the colour bar in dB re level bed."""
        return self._ends

    def show_levels(self, find: Callable[[], NDArray[np.floating]]) -> None:
        """Count levels in dB re level bed, which are asked for when they are next painted: behind a tab, never."""
        self._due = find
        self.update()

    def _count(self) -> None:
        """Count the levels that are due."""
        find, self._due = self._due, None
        if find is not None:
            counts, _ = np.histogram(find(), bins=160, range=(LOWEST, HIGHEST))
            self._counts = np.sqrt(counts / max(int(counts.max()), 1))  # so that rare levels are seen

    def show_colours(self, tone_map: ToneMap) -> None:
        """Show the colours of levels, and the ends of the palette."""
        with np.errstate(divide="ignore"):
            ends = tone_map.ends if tone_map.decibels else 20.0 * np.log10(np.maximum(tone_map.ends, 0.0))
        self._ends = float(ends[0]), float(ends[1])
        levels = np.linspace(LOWEST, HIGHEST, 320, dtype=np.float32)
        self._words = np.ascontiguousarray(tone_map.colours(10.0 ** (levels / np.float32(20.0)))[None, :])
        # The image shares the memory of the words.
        self._bar = QImage(self._words.data, 320, 1, 4 * 320, QImage.Format.Format_RGB32)
        self.update()

    def place_of(self, decibels: float) -> float:
        """Horizontal place of a level in px, at an edge where it lies beyond."""
        share = (min(max(decibels, LOWEST), HIGHEST) - LOWEST) / (HIGHEST - LOWEST)
        return MARGIN + share * (self.width() - 2 * MARGIN)

    def level_at(self, x: float) -> float:
        """Level at a horizontal place in px; minus infinity at the left edge and beyond."""
        share = (x - MARGIN) / max(self.width() - 2 * MARGIN, 1)
        return -np.inf if share <= 0.0 else LOWEST + min(share, 1.0) * (HIGHEST - LOWEST)

    @guard_override(None)
    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw histogram, colour bar, its ends and a scale."""
        self._count()
        with QPainter(self) as painter:
            base = self.height() - BAR - SCALE
            area = QRectF(MARGIN, 2.0, self.width() - 2 * MARGIN, base - 2.0)
            painter.fillRect(area, QColor(RAISED))
            self._draw_counts(painter, area)
            painter.drawImage(QRectF(MARGIN, base, area.width(), BAR), self._bar, QRectF(self._bar.rect()))
            for level in np.arange(LOWEST, HIGHEST + 1.0, STEP):
                place = QRectF(self.place_of(level) - 30.0, base + BAR, 60.0, SCALE)
                painter.setPen(QColor(QUIET))
                text = (
                    "bed" if level == 0.0 else f"{level:+.0f}".replace("-", "−") + (" dB" if level == HIGHEST else "")
                )
                align = {LOWEST: Qt.AlignmentFlag.AlignLeft, HIGHEST: Qt.AlignmentFlag.AlignRight}
                inside = place.translated({LOWEST: 30.0, HIGHEST: -30.0}.get(float(level), 0.0), 0.0)
                painter.drawText(inside, align.get(float(level), Qt.AlignmentFlag.AlignHCenter), text)
            self._draw_ends(painter, base)

    def _draw_counts(self, painter: QPainter, area: QRectF) -> None:
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(QUIET))
        x = np.linspace(area.left(), area.right(), self._counts.size)
        y = area.bottom() - self._counts * (area.height() - 4.0)
        line = [QPointF(a, b) for a, b in zip(x.tolist(), y.tolist())]
        painter.drawPolygon(QPolygonF([QPointF(x[0], area.bottom()), *line, QPointF(x[-1], area.bottom())]))

    def _draw_ends(self, painter: QPainter, base: int) -> None:
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        for number, end in enumerate(self._ends):
            x = self.place_of(end)
            painter.setPen(QPen(QColor(ACCENT if self._held == number or self.hasFocus() else TEXT), 1.5))
            painter.drawLine(QPointF(x, 2.0), QPointF(x, base + BAR))
            painter.setPen(QPen(QColor(GROUND), 1.0))
            painter.setBrush(QColor(ACCENT if self._held == number else TEXT))
            painter.drawRoundedRect(QRectF(x - 4.0, base - 2.0, 8.0, BAR + 4.0), 3.0, 3.0)

    def _end_at(self, x: float) -> int | None:
        """Which end lies at a place; of both, the one on the side of the place."""
        away = [abs(x - self.place_of(end)) for end in self._ends]
        if min(away) > GRIP:
            return None
        if abs(away[0] - away[1]) < 1.0:
            return int(x >= self.place_of(self._ends[1]))
        return int(away[1] < away[0])

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of an end."""
        if event.button() is Qt.MouseButton.LeftButton:
            self._held = self._end_at(event.position().x())
            self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag an end."""
        x = event.position().x()
        if self._held is None:
            there = self._end_at(x) is not None
            self.setCursor(Qt.CursorShape.SizeHorCursor if there else Qt.CursorShape.ArrowCursor)
        else:
            self._move(self._held, self.level_at(x))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go of an end."""
        self._held = None
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move an end by half a decibel."""
        turn = {Qt.Key.Key_Left: -KEY_STEP, Qt.Key.Key_Right: KEY_STEP}.get(Qt.Key(event.key()))
        if turn is None:
            super().keyPressEvent(event)
            return
        number = 0 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        self._move(number, max(self._ends[number], LOWEST) + turn)

    def _move(self, number: int, level: float) -> None:
        low, high = self._ends
        low, high = (min(level, high - APART), high) if number == 0 else (low, max(level, low + APART, LOWEST + APART))
        if (low, high) != self._ends:
            self.dragged.emit(low, high)
