"""Scrolling record with rulers: port left, starboard right, newest ping on top."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen, QResizeEvent, QWheelEvent
from PySide6.QtWidgets import QWidget

from insonify_viewer.record import Record, Rows
from insonify_viewer.session import Mark
from insonify_viewer.views.along_track_blur import blur_along_track
from insonify_viewer.views.echo_trace import CAPTION, GAP, WIDE, draw_caption, draw_trace, room_for_trace
from insonify_viewer.views.pixel_marks import draw_lit, draw_pin
from insonify_viewer.views.pixels import colour_table, colours, column_means, dimmed, with_highlights
from insonify_viewer.views.rulers import draw_ping_ruler, draw_slant_ruler
from insonify_viewer.views.scrub_handle import ScrubHandle
from insonify_viewer.views.theme import GROUND, MARK
from insonify_viewer.views.true_scale import name_scale, plot_at_true_scale
from insonify_viewer.views.waiting_bar import draw_waiting
from insonify_viewer.waiting import Waiting

LEFT, BOTTOM, TOP, RIGHT = 64, 40, 24, 24
PINGS_A_NOTCH = 16
STILL = 3  # px by which the mouse may move in a click
EMPTY = 0xFF0B1118


class WaterfallView(QWidget):
    """Draws a `Record`; a row is coloured once, when it arrives.

    Parameters
    ----------
    native : bool
        Whether the widget owns a native window; beside an OpenGL widget others are drawn several times slower.
    parent : QWidget, optional
        Owner.

    Attributes
    ----------
    version : int
        Counts the changes of the picture.
    """

    hovered = Signal(object)  # Mark or None
    scrolled = Signal(int)  # pings further back
    scrubbed = Signal(int)  # ping to put on top
    clicked = Signal(object)  # Mark

    def __init__(self, *, native: bool = False, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        if native:
            self.setAttribute(Qt.WidgetAttribute.WA_DontCreateNativeAncestors)
            self.setAttribute(Qt.WidgetAttribute.WA_NativeWindow)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.CrossCursor)
        self.setMinimumSize(200, 140)
        self._record = Record(1, 1)
        self._top = 0
        self._range, self._step = 1.0, 1.0
        self._levels, self._gain = (0.0, 1.0), 1.0
        self._table = with_highlights(colour_table(np.repeat(np.arange(256, dtype=np.uint8)[:, None], 3, axis=1)))
        self._mark: Mark | None = None
        self._pin: Mark | None = None
        self._lit: tuple[Mark, ...] = ()
        self._pressed: QPoint | None = None
        self._traced = True  # whether the echo of one ping is drawn below
        self._waiting: Waiting | None = None
        self._oldest = -1  # stamp; rows with an older one are dimmed
        self._notches = self.version = 0
        self._text = 1.0  # factor on the size of the text, and of the margins that hold it
        self._handle = ScrubHandle()
        self._fit()

    @property
    def record(self) -> Record:
        """The pings on screen."""
        return self._record

    @property
    def top(self) -> int:
        """Ping on top."""
        return self._top

    def show_record(self, record: Record, slant_range: float, ping_step: float) -> None:
        """Show another record, given its last slant range and the distance between pings in metres."""
        known, plot = self._record, self._plot()
        self._record, self._range, self._step = record, slant_range, ping_step
        if record is known and plot == self._plot():
            self.update()
        else:
            self._fit()

    def show_rows(self, rows: Rows, alike: int = 1, reach: NDArray[np.float64] | None = None) -> None:
        """Update rows that the record has just received.

        Parameters
        ----------
        rows : (n,) int64
            Rows of successive pings.
        alike : int
            Number of successive pings that are the same.
        reach : (bins,) float64, optional
            Number of pings that the beam covers, over which energy is averaged.
        """
        means = column_means(self._record.amplitude[rows[::alike]], self._columns.shape[1])
        if reach is not None and rows.size:
            means = blur_along_track(means, reach / alike)
        self._columns[rows] = means if alike == 1 else np.repeat(means, alike, axis=0)[: rows.size]
        self._paint_rows(rows)

    def show_top(self, ping: int) -> None:
        """Put a ping on top; blank the rows whose ping is missing or lies above it."""
        if ping == self._top:
            return
        before, self._top = self._top, ping
        pings = self._record.shown(ping)
        rows = self._record.rows(pings)
        held = self._record.ping[rows] == pings
        blank = np.ones(self._record.pings, dtype=bool)
        blank[rows[held]] = False
        self._pixels[blank] = EMPTY
        returned = held & ((pings > before) | (pings <= before - self._record.pings))
        self._paint_rows(rows[returned])

    def show_last(self, ping: int) -> None:
        """Set the last ping that the handle reaches; it does not change while the handle is held."""
        if ping != self._handle.last and not self._handle.held:
            self._handle.last = ping
            self.update()

    def show_palette(self, colours: NDArray[np.uint8]) -> None:
        """Colour by another palette, (256, 3)."""
        self._table = with_highlights(colour_table(colours))
        self._paint_rows(np.arange(self._record.pings))

    def show_levels(self, levels: tuple[float, float], gain: float) -> None:
        """Set the amplitudes at the ends of the palette, and a factor on all amplitudes."""
        if (levels, gain) != (self._levels, self._gain):
            self._levels, self._gain = levels, gain
            self._paint_rows(np.arange(self._record.pings))

    def show_mark(self, mark: Mark | None) -> None:
        """Draw a cross through a point of the record."""
        self._mark = mark
        self.update()

    def show_pin(self, mark: Mark | None) -> None:
        """Draw a ring about the pinned pixel."""
        self._pin = mark
        self.update()

    def show_lit(self, marks: tuple[Mark, ...]) -> None:
        """Light up pixels."""
        self._lit = marks
        self.update()

    def toggle_trace(self) -> None:
        """Show the echo of one ping under the record, or give its room to the record."""
        self._traced = not self._traced
        self._fit()

    @property
    def waiting(self) -> Waiting | None:
        """What the bar over the record says."""
        return self._waiting

    def show_waiting(self, waiting: Waiting | None, oldest: int) -> None:
        """Show a bar over the record with what it waits for, and dim the rows with a stamp before ``oldest``."""
        if waiting != self._waiting:
            self._waiting = waiting
            self.update()
        if waiting is not None and oldest != self._oldest:
            self._oldest = oldest
            self._paint_rows(np.flatnonzero(self._record.stamp < oldest))

    def picture(self) -> NDArray[np.uint32]:
        """Colours of the rows on screen, newest first, as 0xffRRGGBB."""
        return np.asarray(self._pixels[self._record.rows(self._record.shown(self._top))])

    def mark_at(self, place: QPoint) -> Mark | None:
        """Find the bin at a position of the widget; None outside the record."""
        plot = self._plot()
        if not plot.contains(place):
            return None
        record = self._record
        ping = self._top - int((place.y() - plot.top()) / plot.height() * record.pings)
        column = int((place.x() - plot.left() + 0.5) / plot.width() * 2 * record.bins)
        side = int(column >= record.bins)
        return Mark(ping, side, column - record.bins if side else record.bins - 1 - column) if ping >= 0 else None

    def place_of(self, mark: Mark) -> QPoint:
        """Position of a bin in the widget."""
        plot, record = self._plot(), self._record
        column = record.bins + mark.bin if mark.side else record.bins - 1 - mark.bin
        return QPoint(
            plot.left() + int((column + 0.5) / (2 * record.bins) * plot.width()),
            plot.top() + int((self._top - mark.ping + 0.5) / record.pings * plot.height()),
        )

    def _plot(self) -> QRect:
        left, top, right, bottom = map(self._scaled, (LEFT, TOP, RIGHT, BOTTOM))
        below = bottom + (room_for_trace(self.height()) if self._traced else 0)
        room = self.rect().adjusted(left, top, -right, -below)
        return plot_at_true_scale(room, *self.extent())

    def trace_area(self) -> QRect | None:
        """Place of the echo trace, from below the rulers to the end of the view; None where there is none."""
        if not self._traced or not room_for_trace(self.height()):
            return None
        plot = self._plot()
        top = plot.bottom() + self._scaled(BOTTOM) + GAP
        return QRect(plot.left(), top, plot.width(), self.height() - top - 4)

    def trace_caption(self) -> QRect | None:
        """Place of the words that are clicked to show or hide the echo trace; None where there is no room for it."""
        if not room_for_trace(self.height()):
            return None
        plot, area = self._plot(), self.trace_area()
        top = plot.bottom() + 21 if area is None else area.top() - CAPTION - 1
        return QRect(plot.left(), top, WIDE, CAPTION)

    def enlarge_text(self, factor: float) -> None:
        """Draw the text of the rulers by a factor larger than usual."""
        font = self.font()
        font.setPointSizeF(font.pointSizeF() * factor / self._text)
        self.setFont(font)
        self._text = factor
        self._fit()

    def _scaled(self, pixels: int) -> int:
        """Pixels at the usual size of the text, in proportion to its present size."""
        return round(pixels * self._text)

    def extent(self) -> tuple[float, float]:
        """Metres along the track and across it that the record shows."""
        return self._record.pings * max(self._step, 1e-6), 2.0 * self._range

    def _fit(self) -> None:
        """Compute the display columns of every row for the present width."""
        plot = self._plot()
        self._handle.lay(plot.right() + 8.0, plot.top(), plot.height())
        width = max(int(plot.width() * self.devicePixelRatioF()), 2)
        rows = np.arange(self._record.pings)
        self._columns = column_means(self._record.amplitude, width)
        self._pixels = np.full((self._record.pings, width), EMPTY, dtype=np.uint32)
        # The image shares the memory of the array; both live as long as the widget.
        self._image = QImage(self._pixels.data, width, len(rows), 4 * width, QImage.Format.Format_RGB32)
        self._paint_rows(rows)

    def _paint_rows(self, rows: Rows) -> None:
        low, high = self._levels
        painted = colours(self._columns[rows], low / self._gain, high / self._gain, self._table)
        stale = self._record.stamp[rows] < self._oldest
        painted[stale] = dimmed(painted[stale])
        age = self._top - self._record.ping[rows]
        painted[(age < 0) | (age >= self._record.pings) | (self._record.ping[rows] < 0)] = EMPTY
        self._pixels[rows] = painted
        self.version += 1
        self.update()

    def draw_for(self, size: QSize) -> None:
        """Compute the picture for a size while the view is hidden."""
        self.resize(size)
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Compute the display columns for the new width."""
        self._fit()
        super().resizeEvent(event)

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the ring in two pieces, then rulers and cross."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(GROUND))
        plot = self._plot()
        self._draw_ring(painter, plot)
        draw_slant_ruler(painter, plot, self._range, name_scale(plot, *self.extent()), self._text)
        beside = QRect(0, plot.top(), self._scaled(LEFT), plot.height())
        draw_ping_ruler(painter, beside, self._top, self._record.pings, self._step, self._text)
        self._handle.draw(painter, self._top)
        if self._waiting is not None:
            draw_waiting(painter, plot, self._waiting)
        draw_lit(painter, (place for place in map(self.place_of, self._lit) if plot.contains(place)))
        if self._pin is not None and plot.contains(self.place_of(self._pin)):
            draw_pin(painter, self.place_of(self._pin))
        if self._mark is not None:
            self._draw_cross(painter, plot, self._mark)
        self._draw_trace(painter)
        painter.end()

    def _draw_trace(self, painter: QPainter) -> None:
        """Draw the echo of the pinned ping, else of the one under the mouse, else of the one on top."""
        area, record, caption = self.trace_area(), self._record, self.trace_caption()
        if area is None and caption is not None:
            draw_caption(painter, caption, "▸ echo")
        mark = self._pin or self._mark
        ping = self._top if mark is None else mark.ping
        row = int(record.rows(np.array([ping]))[0])
        if area is None or record.ping[row] != ping:
            return
        at = None
        if mark is not None:
            at = ((record.bins + mark.bin if mark.side else record.bins - 1 - mark.bin) + 0.5) / (2 * record.bins)
        draw_trace(painter, area, record.amplitude[row], f"echo of ping {ping}", at)

    def _draw_ring(self, painter: QPainter, plot: QRect) -> None:
        pings, width = self._pixels.shape
        first = self._record.pings - 1 - self._top % self._record.pings
        seam = plot.top() + round((pings - first) / pings * plot.height())
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, pings > plot.height())
        upper = QRect(plot.left(), plot.top(), plot.width(), seam - plot.top())
        painter.drawImage(upper, self._image, QRect(0, first, width, pings - first))
        if first > 0:
            lower = QRect(plot.left(), seam, plot.width(), plot.bottom() + 1 - seam)
            painter.drawImage(lower, self._image, QRect(0, 0, width, first))

    def _draw_cross(self, painter: QPainter, plot: QRect, mark: Mark) -> None:
        place = self.place_of(mark)
        if plot.contains(place):
            for colour, width in ((GROUND, 4), (MARK, 2)):
                painter.setPen(QPen(QColor(colour), width))
                for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
                    painter.drawLine(place + QPoint(5 * dx, 5 * dy), place + QPoint(14 * dx, 14 * dy))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of the handle, or move it to a place on its rail."""
        if event.button() is Qt.MouseButton.LeftButton and self._handle.contains(event.position()):
            self._handle.held = True
            self._scrub(event)
        elif event.button() is Qt.MouseButton.LeftButton:
            self._pressed = event.position().toPoint()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go of the handle, or signal a click into the record."""
        if event.button() is not Qt.MouseButton.LeftButton:
            return
        place, pressed, self._pressed = event.position().toPoint(), self._pressed, None
        if self._handle.held:
            self._handle.held = False
            self.update()
        elif pressed is not None and (place - pressed).manhattanLength() <= STILL:
            self._click(place)

    def _click(self, place: QPoint) -> None:
        """Signal the pixel at a place, or show or hide the echo trace by its caption."""
        mark, caption = self.mark_at(place), self.trace_caption()
        if mark is not None:
            self.clicked.emit(mark)
        elif caption is not None and caption.contains(place):
            self.toggle_trace()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Signal the bin under the mouse, or the ping at the handle."""
        if self._handle.held:
            self._scrub(event)
            return
        on_rail = self._handle.contains(event.position())
        self.setCursor(Qt.CursorShape.SizeVerCursor if on_rail else Qt.CursorShape.CrossCursor)
        self.setToolTip("Drag to any ping of the tow" if on_rail else "")
        self.hovered.emit(self.mark_at(event.position().toPoint()))

    def _scrub(self, event: QMouseEvent) -> None:
        self.scrubbed.emit(self._handle.ping_at(event.position()))
        self.update()

    def leaveEvent(self, event: QEvent) -> None:
        """Signal that the mouse has left."""
        self.hovered.emit(None)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Signal by how many pings to look back; touchpads send fractions of a notch."""
        self._notches += event.angleDelta().y()
        pings = int(self._notches * PINGS_A_NOTCH / 120)
        if pings:
            self._notches = 0
            # Wheel down moves to older pings.
            self.scrolled.emit(-pings)
        event.accept()
