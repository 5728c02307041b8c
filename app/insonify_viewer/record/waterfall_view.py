"""Scrolling record, pointed at, moved, zoomed and measured by mouse or keys, and its contrast."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QPoint, QRect, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QFocusEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from insonify.display.display_options import DisplayOptions
from insonify.display.picture import choose_contrast
from insonify.errors import plain_text
from insonify_viewer.errors import guard_override
from insonify_viewer.record.record import Record
from insonify_viewer.record.record_canvas import RecordCanvas
from insonify_viewer.record.record_handles import RecordHandles
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.session import Session
from insonify_viewer.widgets.arrow_keys import ENTER, modifiers_of, steps_of
from insonify_viewer.widgets.theme import TEXT

PINGS_A_NOTCH = 16
NOTCH = 120  # of the wheel, in eighths of a degree
CLOSER = 1.25  # magnification by a notch
SIDEWAYS = 0.1  # share of the plot by which a notch moves it across
STILL = 3  # px by which the mouse may move in a click
PAGES: dict[int, int] = {Qt.Key.Key_PageUp: -1, Qt.Key.Key_PageDown: 1}  # down
KEYS = "Arrow keys move the cursor and the record, Return explains the pixel at the cursor, C marks a contact there."
BY_TAB = Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason
SAMPLED = 4  # every so many rows are looked at


class WaterfallView(RecordCanvas):
    """Draws a record, and signals what mouse and keys do to it."""

    # Keys move a cursor from bin to bin, and the record under it from ping to ping, in the direction of the wheel.

    hovered = Signal(object)  # Mark or None
    scrolled = Signal(int)  # pings further back
    scrubbed = Signal(int)  # ping to put on top
    clicked = Signal(object)  # Mark
    menu_wanted = Signal(object, QPoint)  # Mark or None, and a place of the screen
    measured = Signal(object, object)  # Marks of both ends of a line

    def __init__(self, *, native: bool = False, parent: QWidget | None = None) -> None:
        super().__init__(native=native, parent=parent)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.CrossCursor)
        self.setAccessibleName("Record")
        self.setAccessibleDescription(KEYS)
        self._measuring, self.title = False, ""
        self._begun: Mark | None = None  # where the Return key has begun a line
        self.is_covered: Callable[[QPoint], bool] = lambda _: False
        self._cursor = RecordCursor(lambda: self.plot_area, self.mark_at, self.place_of)
        self.handles = RecordHandles(self.places_of, self.update, self)
        self._pressed: QPoint | None = None
        self._taken: QPoint | None = None  # where a handle was taken
        self._dragged: QPoint | None = None  # where a drag under way has come to
        self._notches = 0.0

    @property
    def measuring(self) -> bool:
        """Whether a drag, or Return at both ends, measures; else a drag moves the record, and Return explains."""
        return self._measuring

    @measuring.setter
    def measuring(self, measuring: bool) -> None:
        self._measuring, self._begun = measuring, None

    @property
    def cursor_place(self) -> QPoint | None:
        """Where the cursor is in the view; None without the keyboard."""
        return self._cursor.place if self.hasFocus() else None

    def magnify(self, factor: float, place: QPoint | None = None) -> None:
        """Zoom about a place of the plot, else about its middle."""
        plot = self.plot_area
        place = plot.center() if place is None else place
        u = (place.x() - plot.left()) / max(plot.width(), 1)
        v = (place.y() - plot.top()) / max(plot.height(), 1)
        self.show_zoom(self.projection.zoom.about(u, v, factor))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of the handle, or move it to a place on its rail; or begin a click or a drag."""
        if event.button() is Qt.MouseButton.LeftButton and self.handle.contains(event.position()):
            self.handle.held = True
            self._scrub(event)
        elif event.button() is Qt.MouseButton.LeftButton and not self._take_handle(event.position().toPoint()):
            self._pressed = event.position().toPoint()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go of the handle or the record, or signal a click into it."""
        if event.button() is not Qt.MouseButton.LeftButton:
            return
        place, pressed, dragged = event.position().toPoint(), self._pressed, self._dragged
        self._pressed = self._dragged = None
        if self.handles.held:
            self.handles.release()
            if self._taken is not None and (place - self._taken).manhattanLength() <= STILL:
                self._click(place)
        elif self.handle.held:
            self.handle.held = False
            self.update()
        elif pressed is not None and dragged is None and (place - pressed).manhattanLength() <= STILL:
            self._click(place)

    def _click(self, place: QPoint) -> None:
        """Signal the pixel at a place, or show or hide the echo trace by its caption."""
        mark, caption = self.mark_at(place), self.trace_caption()
        if mark is not None:
            self.clicked.emit(mark)
        elif caption is not None and caption.contains(place):
            self.toggle_trace()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Signal the bin under the mouse, or the ping at the handle; or go on with a drag."""
        place = event.position().toPoint()
        if self.handle.held:
            self._scrub(event)
            return
        if self.handles.held:
            if (mark := self.mark_at(place)) is not None:
                self.handles.pulled.emit(mark)
            return
        if self._pressed is not None and (self._dragged or (place - self._pressed).manhattanLength() > STILL):
            self._drag(place)
        on_rail = self.handle.contains(event.position())
        gripped = self.handles.hover(place)
        cross = Qt.CursorShape.SizeAllCursor if gripped else Qt.CursorShape.CrossCursor
        self.setCursor(Qt.CursorShape.SizeVerCursor if on_rail else cross)
        self.setToolTip("Drag to any ping of the tow" if on_rail else gripped)
        self._cursor.put(place)
        self.hovered.emit(self.mark_at(place))

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Signal where a menu is wanted: under the mouse, or at the cursor by the key for it."""
        by_key = event.reason() is QContextMenuEvent.Reason.Keyboard
        place = self._cursor.place if by_key else event.pos()
        self.menu_wanted.emit(self.mark_at(place), self.mapToGlobal(place))

    def show_title(self, title: str) -> None:
        """Write a title above the record; an empty one is none."""
        title = plain_text(title)
        if title != self.title:
            self.title = title
            self.setAccessibleName(f"Record {title}".strip())
            self.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the record and its title."""
        super().paint(painter)
        plot, metrics = self.plot_area, painter.fontMetrics()
        painter.setPen(QColor(TEXT))
        room = plot.width() - 2 * metrics.horizontalAdvance("starboard") - 16
        title = metrics.elidedText(self.title, Qt.TextElideMode.ElideMiddle, max(room, 0))
        heading = QRect(plot.left(), plot.top() - self._scaled(20), plot.width(), self._scaled(16))
        painter.drawText(heading, Qt.AlignmentFlag.AlignHCenter, title)

    def _take_handle(self, place: QPoint) -> bool:
        """Take hold of the handle of a target, unless a drag measures."""
        self._taken = place
        return not self.measuring and self.handles.take(place, self.mark_at(place))

    def _draw_over(self, painter: QPainter, plot: QRect) -> None:
        super()._draw_over(painter, plot)
        self.handles.draw(painter)

    def _drag(self, place: QPoint) -> None:
        """Measure from where the drag began, or move the record with the mouse."""
        assert self._pressed is not None
        before, self._dragged = self._dragged or self._pressed, place
        if self.measuring:
            near, far = self.mark_at(self._pressed), self.mark_at(place)
            if near is not None and far is not None:
                self.measured.emit(near, far)
            return
        plot, zoom = self.plot_area, self.projection.zoom
        u = (before.x() - place.x()) / max(plot.width(), 1)
        v = (before.y() - place.y()) / max(plot.height(), 1)
        self._move(u, v * (zoom.lower - zoom.upper) * self.record.pings)

    def _move(self, across: float, down: float) -> None:
        """Show what lies to the right by a share of the plot, and below by some pings."""
        zoom, pings = self.projection.zoom, self.record.pings
        moved = zoom.moved(across, down / ((zoom.lower - zoom.upper) * pings))
        self.show_zoom(moved if moved != zoom else self.zoom)
        # The zoom goes no farther; the tow may.
        self._scroll_by(down - (moved.upper - zoom.upper) * pings)

    def _scrub(self, event: QMouseEvent) -> None:
        self.scrubbed.emit(self.handle.ping_at(event.position()))
        self.update()

    @guard_override(None)
    def leaveEvent(self, event: QEvent) -> None:
        """Signal that the mouse has left."""
        self.hovered.emit(None)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Signal by how many pings to look back; with Ctrl zoom about the mouse, with Shift move across."""
        turned = event.angleDelta().y() or event.angleDelta().x()  # Qt turns the wheel sideways with Alt
        keys, zoom = event.modifiers(), self.projection.zoom
        if keys & Qt.KeyboardModifier.ControlModifier:
            self.magnify(CLOSER ** (turned / NOTCH), event.position().toPoint())
        elif keys & Qt.KeyboardModifier.ShiftModifier:
            self.show_zoom(zoom.moved(-SIDEWAYS * turned / NOTCH, 0.0))
        else:
            self._scroll_by(-turned * PINGS_A_NOTCH / NOTCH)
        event.accept()

    def _scroll_by(self, pings: float) -> None:
        """Move the picture up by some pings, and signal by how many to look back; touchpads send fractions."""
        self._notches += pings if self.look.newest_on_top else -pings
        whole = int(self._notches)
        if whole:
            self._notches -= whole
            self.scrolled.emit(whole)

    @guard_override(None)
    def focusInEvent(self, event: QFocusEvent) -> None:
        """Show the cursor to the person who comes by the Tab key."""
        super().focusInEvent(event)
        if event.reason() in BY_TAB:
            self._point()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move cursor and record, go to an end of the tow, or pin the pixel at the cursor."""
        key, keys, steps = event.key(), modifiers_of(event), steps_of(event)
        if steps is not None:
            self._step_across(steps[0])
            self._step_down(steps[1])
            self._point()
        elif key in PAGES and not keys:
            upper, lower = self.projection.ages
            self._move_under_cursor(PAGES[key] * abs(lower - upper))
            self._point()
        elif key in (Qt.Key.Key_Home, Qt.Key.Key_End) and keys == Qt.KeyboardModifier.ControlModifier:
            self._go_to_end((key == Qt.Key.Key_Home) == self.look.newest_on_top)
        elif key in ENTER and not keys:
            self._enter()
        else:
            super().keyPressEvent(event)

    def _enter(self) -> None:
        """Begin or end a line at the cursor while measuring; else signal a click there."""
        self._point()
        place = self._cursor.place
        if self.measuring:
            self._begun = self.mark_at(place) if self._begun is None else None
        elif not self.is_covered(place):
            self._click(place)

    def _step_across(self, bins: int) -> None:
        """Move the cursor along the row; at an edge of the plot, a zoomed record moves with it."""
        way = 1 if bins > 0 else -1
        for _ in range(abs(bins)):
            if not self._cursor.step(way, 0):
                self._move(SIDEWAYS * way, 0.0)
                self._cursor.step(way, 0)

    def _step_down(self, pings: int) -> None:
        """Move the record under the cursor, or the cursor where the record goes no farther."""
        before = self.top, self.zoom
        self._move_under_cursor(pings)
        if (self.top, self.zoom) == before:
            for _ in range(abs(pings)):
                self._cursor.step(0, 1 if pings > 0 else -1)

    def _move_under_cursor(self, down: float) -> None:
        """Move the record by some pings while the cursor stays where it is in the view."""
        place = self._cursor.place
        self._move(0.0, down)
        self._cursor.put(place)

    def _go_to_end(self, newest: bool) -> None:
        """Signal the last ping of the tow, or the one on top of its first page."""
        place, last = self._cursor.place, self.handle.last
        self.scrubbed.emit(last if newest else min(self.record.pings - 1, last))
        self._cursor.put(place)
        self._point()

    def _point(self) -> None:
        """Signal the bin at the cursor as if the mouse were there."""
        place = self._cursor.place
        self._cursor.put(place)
        mark = self.mark_at(place)
        if not self.is_covered(place):
            self.hovered.emit(mark)
        if self._begun is not None and mark is not None:
            self.measured.emit(self._begun, mark)


class RecordCursor:
    """A place of the plot, from where the mouse last was; it follows its bin when the record is zoomed or moves."""

    def __init__(
        self,
        plot: Callable[[], QRect],
        mark_at: Callable[[QPoint], Mark | None],
        place_of: Callable[[Mark], QPoint],
    ) -> None:
        self._plot, self._mark_at, self._place_of = plot, mark_at, place_of
        self._place = QPoint(-1, -1)
        self._mark: Mark | None = None

    @property
    def place(self) -> QPoint:
        """Position in the view; the middle of the plot where the cursor was left out of sight."""
        if self._plot().contains(self._place) and self._mark_at(self._place) == self._mark:
            return self._place
        moved = self._place if self._mark is None else self._place_of(self._mark)
        return moved if self._plot().contains(moved) else self._plot().center()

    def put(self, place: QPoint) -> None:
        """Put the cursor at a position of the view."""
        self._place, self._mark = place, self._mark_at(place)

    def step(self, across: int, down: int) -> bool:
        """Go to the nearest place of another bin in a direction; return whether the plot has one."""
        place = self.place
        here, plot = self._mark_at(place), self._plot()
        there = place + QPoint(across, down)
        while here is not None and plot.contains(there) and self._mark_at(there) == here:
            there += QPoint(across, down)
        inside = plot.contains(there)
        self.put(there if inside else place)
        return inside


class Contrast:
    """Shows a record by the display options, and chooses the ends of the palette where these leave them open."""

    def __init__(self, waterfall: WaterfallView, session: Session) -> None:
        self._waterfall, self._decibels = waterfall, session.display.decibels
        self.due = True
        session.displayed.connect(self._show)
        waterfall.show_display(session.display)

    def settle(self, record: Record, *, complete: bool) -> None:
        """Choose the contrast anew if it is due, for the last time when the record is complete."""
        if self.due:
            heard = record.amplitude[record.ping >= 0][::SAMPLED]
            self._waterfall.show_levels(choose_contrast(heard, decibels=self._decibels))
            self.due = not complete

    def _show(self, look: DisplayOptions) -> None:
        self._waterfall.show_display(look)
        if look.decibels is not self._decibels:
            self._decibels, self.due = look.decibels, True
            self.settle(self._waterfall.record, complete=True)
