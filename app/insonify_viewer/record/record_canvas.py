"""Drawing of a record with rulers by the display options of the session."""

from dataclasses import replace
from typing import Any

import numpy as np
from PySide6.QtCore import QPoint, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QResizeEvent
from PySide6.QtWidgets import QWidget

from insonify.arrays import Booleans, Floats, Integers, Singles
from insonify.display.display_options import DisplayOptions, Levels
from insonify_viewer.errors import guard_override
from insonify_viewer.record import record_overlays as overlays
from insonify_viewer.record.echo_trace import CAPTION, GAP, ROOMY, WIDE, draw_caption, draw_trace, room_for_trace
from insonify_viewer.record.projection import (
    Zoom,
    choose_axis,
    name_scale,
    project_record,
    zoom_to_true_scale,
)
from insonify_viewer.record.record import Record
from insonify_viewer.record.record_image import DrawnRows, RecordImage, RecordOverview
from insonify_viewer.record.tone_map import make_tone_map
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.painting import Painted
from insonify_viewer.widgets.theme import GROUND, text_scale
from insonify_viewer.work.waiting import Waiting

LEFT, BOTTOM, TOP, RIGHT = 64, 40, 24, 34
HIDDEN_TRACE = "▸ echo"  # is clicked to show the echo trace
GEOMETRY = ("side", "ground_range", "water_column", "side_gains", "side_slopes", "newest_on_top", "scale")


class RecordCanvas(Painted):
    """Draws a `Record`; a row is coloured once, when it arrives."""

    moved = Signal(int)  # newest ping on screen
    zoomed = Signal(object)  # the `Zoom` that is shown now
    recoloured = Signal()  # the colours of amplitudes have changed

    def __init__(self, *, native: bool = False, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        if native:
            self.setAttribute(Qt.WidgetAttribute.WA_DontCreateNativeAncestors)
            self.setAttribute(Qt.WidgetAttribute.WA_NativeWindow)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setMinimumSize(200, 140)
        self.record = Record(1, 1)  # the pings on screen
        self.top = 0  # newest ping on screen
        self.image = RecordImage()
        self._range, self._step = 1.0, 1.0
        # Amplitudes at the ends of the palette, where the display options leave them to the record.
        self.levels: Levels = (0.0, 1.0)
        self.look, self.zoom = DisplayOptions(), Zoom()
        self.marks = overlays.RecordMarks()
        self.errors: overlays.BinErrors | None = None
        self._traced: bool | None = None  # whether the echo of one ping is drawn below; None: where the view is high
        self.waiting: Waiting | None = None  # what the bar over the record says
        self._preview = False  # whether rows are interpolated between traced pings
        self._points = self.font().pointSizeF()  # usual size of the text
        self._text = text_scale(self)  # factor on the margins that hold the text
        self.handle = overlays.ScrubHandle()
        self.overview = RecordOverview()
        self._fit()

    @property
    def step(self) -> float:
        """Distance between pings in metres."""
        return max(self._step, 1e-6)

    def show_record(self, record: Record, slant_range: float, ping_step: float) -> None:
        """Show another record, given its last slant range and the distance between pings in metres."""
        known, plot, axis = self.record, self.plot_area, self.projection.axis
        self.record, self._range, self._step = record, slant_range, ping_step
        if record is not known:
            self.overview = RecordOverview()
        self._lay()
        if record is known and plot == self.plot_area and axis == self.projection.axis:
            self.update()
        else:
            self._fit()

    def draw_rows(self, amplitude: Singles, altitude: Floats, reach: Floats | None) -> DrawnRows | None:
        """Draw rows, (n, 2, bins), for `show_rows` beside the window; None for a record of other bins."""
        layout = self.image.layout
        if layout is None or layout.projection.axis.bins != amplitude.shape[2]:
            return None
        return layout.draw(np.concatenate([amplitude[:, 0, ::-1], amplitude[:, 1]], axis=1), altitude, reach)

    def show_rows(
        self,
        rows: Integers,
        reach: Floats | None = None,
        *,
        preview: bool = False,
        drawn: DrawnRows | None = None,
    ) -> None:
        """Update rows that the record has just received, the last of a preview or not, as they are drawn already."""
        self._preview = preview
        if not preview:
            self.overview.put(self.record, rows)
        if not self.projection.axis.shows_water or self.look.ground_range or not self.look.water_column:
            axis = choose_axis(self.look, self.record, self._range)
            if axis != self.projection.axis:  # a ping from lower altitude reaches farther on the bed
                self._fit()
        self.image.put(rows, self.projection, self.tone_map, reach, drawn)
        self.update()

    def show_top(self, ping: int) -> None:
        """Put a ping on top; blank rows of missing pings and of pings above it."""
        if ping == self.top:
            return
        before, self.top = self.top, ping
        self._project()
        pings = self.record.shown(ping)
        rows = self.record.rows(pings)
        held = self.record.ping[rows] == pings
        blank = np.ones(self.record.pings, dtype=bool)
        blank[rows[held]] = False
        self.image.blank(np.flatnonzero(blank))
        returned = held & ((pings > before) | (pings <= before - self.record.pings))
        self._paint_rows(rows[returned])
        self.moved.emit(ping)

    def show_last(self, ping: int) -> None:
        """Set the last ping that the handle reaches; it does not change while the handle is held."""
        if ping != self.handle.last and not self.handle.held:
            self.handle.last = ping
            self.update()

    def show_display(self, look: DisplayOptions) -> None:
        """Show the record by other display options."""
        before, self.look = self.look, look
        self.handle.newest_on_top = look.newest_on_top
        self.tone_map = make_tone_map(look, self.levels)
        if any(getattr(before, name) != getattr(look, name) for name in GEOMETRY):
            if before.side != look.side:
                self.zoom = Zoom()
            self._fit()
        else:
            self._paint_rows(np.arange(self.record.pings))
        self.recoloured.emit()

    def show_levels(self, levels: Levels) -> None:
        """Set the amplitudes at the ends of the palette, where the display options leave them to the record."""
        if levels != self.levels:
            self.levels = levels
            self.tone_map = make_tone_map(self.look, levels)
            self._paint_rows(np.arange(self.record.pings))
            self.recoloured.emit()

    def show_zoom(self, zoom: Zoom) -> None:
        """Show a part of the record."""
        if zoom != self.zoom:
            self.zoom = zoom
            self._fit()
            self.zoomed.emit(zoom)

    def show_marks(self, **changes: Any) -> None:
        """Change some of the `RecordMarks`, and draw the record anew unless they are as before."""
        changed = replace(self.marks, **changes)
        if changed != self.marks:
            self.marks = changed
            self.update()

    def show_errors(self, errors: overlays.BinErrors | None) -> None:
        """Lay errors of bins over the record; None takes them away."""
        self.errors = errors
        self.update()

    def toggle_trace(self) -> None:
        """Show the echo of one ping under the record, or give its room to the record."""
        self._traced = not self._shows_trace
        self._fit()

    def show_waiting(self, waiting: Waiting | None, oldest: int) -> None:
        """Show a bar over the record with what it waits for, and dim the rows with a stamp before ``oldest``."""
        if waiting != self.waiting:
            self.waiting = waiting
            self.update()
        if waiting is not None and oldest != self.image.oldest:
            self.image.oldest = oldest
            self._paint_rows(np.flatnonzero(self.record.stamp < oldest))

    def shown_columns(self) -> tuple[Singles, Booleans]:
        """Return the display columns of the rows on screen, newest first, and which of them are stored."""
        pings = self.record.shown(self.top)
        rows = self.record.rows(pings)
        return self.image.columns(rows), self.record.ping[rows] == pings

    def snapshot(self, mark: Mark) -> bytes:
        """Picture of the record about a bin as PNG, without what is painted over it."""
        return self.image.snapshot(self.plot_area, self.projection, self.place_of(mark))

    def mark_at(self, place: QPoint) -> Mark | None:
        """Find the bin at a position of the widget; None outside the record."""
        plot = self.plot_area
        if not plot.contains(place):
            return None
        u = (place.x() - plot.left() + 0.5) / plot.width()
        return self.projection.mark_at(u, (place.y() - plot.top() + 0.5) / plot.height())

    def place_of(self, mark: Mark) -> QPoint:
        """Position of a bin in the widget; outside the record where the picture leaves it out."""
        return QPoint(*self.places_of(np.array([[mark.ping, mark.side, mark.bin]]))[0].tolist())

    def places_of(self, marks: Integers) -> Integers:
        """Positions in the widget, (n, 2), of bins, (n, 3) ping, side and bin."""
        plot = self.plot_area
        shares = self.projection.places_of(marks) * (plot.width(), plot.height())
        return np.array([plot.left(), plot.top()]) + shares.astype(np.int64)

    @property
    def _shows_trace(self) -> bool:
        return self.height() >= ROOMY if self._traced is None else self._traced

    def _room(self) -> QRect:
        left, top, right, bottom = map(self._scaled, (LEFT, TOP, RIGHT, BOTTOM))
        below = bottom + (room_for_trace(self.height()) if self._shows_trace else 0)
        return self.rect().adjusted(left, top, -right, -below)

    def trace_area(self) -> QRect | None:
        """Place of the echo trace, from below the rulers to the end of the view; None where there is none."""
        if not self._shows_trace or not room_for_trace(self.height()):
            return None
        plot = self.plot_area
        top = plot.bottom() + self._scaled(BOTTOM) + GAP
        return QRect(plot.left(), top, plot.width(), self.height() - top - 4)

    def trace_caption(self) -> QRect | None:
        """Place of the words that are clicked to show or hide the echo trace; None where there is no room for it."""
        if not room_for_trace(self.height()):
            return None
        plot, area = self.plot_area, self.trace_area()
        top = plot.bottom() + self._scaled(21) if area is None else area.top() - CAPTION - 1
        return QRect(plot.left(), top, self._scaled(WIDE), CAPTION)

    def enlarge_text(self, factor: float) -> None:
        """Draw the text of the rulers by a factor larger than usual."""
        points = factor * self._points
        self.setStyleSheet(f"font-size: {points:g}pt" if factor != 1.0 else "")  # another theme would reset a font
        self.ensurePolished()
        self._text = text_scale(self)
        self._fit()

    def _scaled(self, pixels: int) -> int:
        """Pixels at the usual size of the text, in proportion to its present size."""
        return round(pixels * self._text)

    def extent(self) -> tuple[float, float]:
        """Metres along the track and across it of the whole record."""
        first, last = self.projection.extent
        return self.record.pings * max(self._step, 1e-6), last - first

    def _shown_extent(self) -> tuple[float, float]:
        """Metres along the track and across it that the plot shows."""
        along, across = self.extent()
        zoom = self.projection.zoom
        return along * (zoom.lower - zoom.upper), across * (zoom.right - zoom.left)

    def _lay(self) -> None:
        """Place plot and handle in the view."""
        axis, room, zoom = choose_axis(self.look, self.record, self._range), self._room(), self.zoom
        across = axis.reach * (2.0 if self.look.side == "both" else 1.0)
        self.plot_area = QRect(room.topLeft(), room.size().expandedTo(QSize(1, 1)))
        if self.look.scale == "true":
            along, size = self.record.pings * self.step, (self.plot_area.width(), self.plot_area.height())
            zoom = zoom_to_true_scale(zoom, size, across, along, newest_on_top=self.look.newest_on_top)
        self.projection = project_record(self.look, self.record, axis, zoom, self.top)
        self.handle.lay(self.plot_area.right() + 8.0, self.plot_area.top(), self.plot_area.height())

    def _project(self) -> None:
        known = self.projection
        self.projection = project_record(self.look, self.record, known.axis, known.zoom, self.top)

    def _fit(self) -> None:
        """Compute the display columns of every row for the present width."""
        self._lay()
        self.tone_map = make_tone_map(self.look, self.levels)
        width = max(int(self.plot_area.width() * self.devicePixelRatioF()), 2)
        self.image.fit(self.record, self.projection, self.tone_map, width)
        self.update()

    def _paint_rows(self, rows: Integers) -> None:
        self.image.paint(rows, self.projection, self.tone_map)
        self.update()

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Compute the display columns for the new width."""
        self._fit()
        super().resizeEvent(event)

    def paint(self, painter: QPainter) -> None:
        """Draw the record, what lies over it, and the rulers."""
        plot, projection = self.plot_area, self.projection
        painter.fillRect(self.rect(), QColor(GROUND))
        self.image.draw(painter, plot, projection)
        shown = self.trace_caption() is not None and self.trace_area() is None
        taken = painter.fontMetrics().horizontalAdvance(f"{HIDDEN_TRACE}  ") if shown else 0
        scale = name_scale(plot, *self._shown_extent())
        overlays.draw_range_ruler(painter, plot, projection, scale, self._text, taken)
        beside = QRect(0, plot.top(), self._scaled(LEFT), plot.height())
        overlays.draw_ping_ruler(painter, beside, projection, self._step, self._text)
        first, last = (projection.newest - age for age in projection.ages)
        strip = self.overview.draw(self.handle.room, self.handle.last, self.tone_map)
        self.handle.draw(painter, self.top, strip, (first, last))
        painter.save()
        painter.setClipRect(plot)
        self._draw_over(painter, plot)
        painter.restore()
        self._draw_trace(painter)

    def _draw_over(self, painter: QPainter, plot: QRect) -> None:
        """Draw lines, marks and the bar of what is waited for over the record."""
        if self.errors is not None and self.errors.shares.shape[1] == 2 * self.record.bins:
            overlays.draw_errors(painter, plot, self.projection, self.errors)
        if self.look.range_lines:
            overlays.draw_range_lines(painter, plot, self.projection, self._text)
        if self.look.bottom_line:
            overlays.draw_bottom_line(painter, plot, self.projection)
        overlays.draw_range_bar(painter, plot, self.projection)
        if self.waiting is not None:
            overlays.draw_waiting(painter, plot, self.waiting)
        elif self._preview:
            overlays.draw_word(painter, plot, "preview")
        self.marks.draw(painter, plot, self.place_of)

    def _draw_trace(self, painter: QPainter) -> None:
        """Draw the echo of the pinned ping, else of the one under the mouse, else of the newest one."""
        area, record, caption = self.trace_area(), self.record, self.trace_caption()
        if area is None and caption is not None:
            draw_caption(painter, caption, HIDDEN_TRACE)
        mark = self.marks.pointed
        ping = self.top if mark is None else mark.ping
        row = int(record.rows(np.array([ping]))[0])
        if area is None or record.ping[row] != ping:
            return
        at = None if mark is None else self.projection.place_of(mark)[0]
        loudest = self.projection.loudest(record.amplitude[row], ping, max(area.width(), 1))
        draw_trace(painter, area, loudest, f"echo of ping {ping}", at)
