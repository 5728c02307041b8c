"""A recording as it scrolls, with the simulated record wiped over it from the left."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPoint, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen, QResizeEvent
from PySide6.QtWidgets import QWidget

from insonify_viewer.session import Mark
from insonify_viewer.views.record_image import EMPTY
from insonify_viewer.views.theme import ACCENT, TEXT
from insonify_viewer.views.waterfall_view import WaterfallView

GRIP = 6  # px beside the split line in which it is taken hold of


class RecordingView(WaterfallView):
    """Draws a recording; wiped, the simulated record covers it left of a line that is dragged, at the same scale.

    Parameters
    ----------
    simulated : WaterfallView
        Draws the simulated record.
    native : bool
        Whether the widget owns a native window.
    parent : QWidget, optional
        Owner.
    """

    def __init__(self, simulated: WaterfallView, *, native: bool = False, parent: QWidget | None = None) -> None:
        super().__init__(native=native, parent=parent)
        self._simulated = simulated
        self._followed = -1  # version of the simulated record that is drawn
        self._title = ""
        self._wiped = self._wiping = False
        self._split = 0.5  # share of the plot that the simulated record covers

    def show_title(self, title: str) -> None:
        """Write a title above the recording."""
        self._title = title
        self.update()

    def show_wipe(self, wiped: bool) -> None:
        """Wipe the simulated record over the recording, or draw the recording alone."""
        self._wiped = wiped
        if wiped:
            self._simulated.draw_for(self.size())
        self.update()

    def follow_simulated(self) -> None:
        """Draw the simulated record anew if it has changed."""
        if self._wiped and self._followed != self._simulated.version:
            self._followed = self._simulated.version
            self.update()

    @property
    def split(self) -> int:
        """Place of the split line, in pixels from the left of the view."""
        plot = self._plot()
        return plot.left() + round(self._split * plot.width())

    def mark_at(self, place: QPoint) -> Mark | None:
        """Find the recorded bin at a position; None outside, and where the simulated record covers it."""
        if self._wiped and place.x() < self.split:
            return None
        return super().mark_at(place)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Compute both pictures for the new width."""
        super().resizeEvent(event)
        if self._wiped:
            self._simulated.draw_for(self.size())

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the recording, its title, and the simulated record over its left part."""
        super().paintEvent(event)
        painter, plot = QPainter(self), self._plot()
        heading = QRect(plot.left(), plot.top() - 20, plot.width(), 16)
        painter.setPen(QColor(TEXT))
        room = max(plot.width() - 2 * painter.fontMetrics().horizontalAdvance("starboard") - 16, 0)
        title = painter.fontMetrics().elidedText(self._title, Qt.TextElideMode.ElideMiddle, room)
        painter.drawText(heading, Qt.AlignmentFlag.AlignHCenter, title)
        if self._wiped:
            self._draw_simulated(painter, plot)
            self._draw_split(painter, plot)
        painter.end()

    def _draw_simulated(self, painter: QPainter, plot: QRect) -> None:
        """Draw the simulated record left of the split line, metre for metre beside the recording."""
        covered = QRect(plot.left(), plot.top(), self.split - plot.left(), plot.height())
        painter.save()
        painter.setClipRect(covered)
        painter.fillRect(covered, QColor(EMPTY))
        pixels = self._simulated.picture()
        if not self._look.newest_on_top:
            pixels = np.ascontiguousarray(pixels[::-1])
        if pixels.size:
            rows, width = pixels.shape
            image = QImage(pixels.data, width, rows, 4 * width, QImage.Format.Format_RGB32)
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            painter.drawImage(self.place_of_simulated(rows), image, QRectF(0, 0, width, rows))
        painter.restore()

    def place_of_simulated(self, pings: int) -> QRectF:
        """Where a number of simulated pings lie at the scale of the recording, from its newest ping on."""
        plot, mine, theirs = self._plot(), self._projection, self._simulated.projection
        along = self._simulated.extent()[0] / self._simulated.record.pings * self._record.pings / self.extent()[0]
        left, right = mine.across(np.array(theirs.shown)) * plot.width() + plot.left()
        ends = mine.down(np.array([mine.newest, mine.newest - pings * along])) * plot.height() + plot.top()
        return QRectF(left, ends.min(), right - left, abs(ends[1] - ends[0]))

    def _draw_split(self, painter: QPainter, plot: QRect) -> None:
        x = self.split
        painter.setPen(QPen(QColor(ACCENT), 2))
        painter.drawLine(x, plot.top(), x, plot.bottom())
        painter.setBrush(QColor(ACCENT))
        painter.drawEllipse(QPoint(x, plot.center().y()), GRIP, GRIP)
        top = plot.bottom() - 22
        for text, left, align in (
            ("simulated", x - 108, Qt.AlignmentFlag.AlignRight),
            ("recorded", x + 8, Qt.AlignmentFlag.AlignLeft),
        ):
            painter.drawText(QRect(left, top, 100, 16), align, text)

    def _on_split(self, event: QMouseEvent) -> bool:
        place, plot = event.position(), self._plot()
        return self._wiped and abs(place.x() - self.split) <= GRIP and plot.top() <= place.y() <= plot.bottom()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of the split line, or of the handle."""
        if event.button() is Qt.MouseButton.LeftButton and self._on_split(event):
            self._wiping = True
        else:
            super().mousePressEvent(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the split line, or signal what is under the mouse."""
        if not self._wiping:
            super().mouseMoveEvent(event)
            if self._on_split(event):
                self.setCursor(Qt.CursorShape.SplitHCursor)
            return
        plot = self._plot()
        self._split = min(max((event.position().x() - plot.left()) / max(plot.width(), 1), 0.0), 1.0)
        self.update()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go of the split line, or of the handle."""
        if self._wiping:
            self._wiping = False
        else:
            super().mouseReleaseEvent(event)
