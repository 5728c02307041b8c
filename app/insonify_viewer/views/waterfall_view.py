"""Scrolling record that is pointed at, scrubbed, moved, zoomed and measured with the mouse."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPoint, QRect, Qt, Signal
from PySide6.QtGui import QMouseEvent, QPainter, QWheelEvent
from PySide6.QtWidgets import QWidget

from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.views.record_canvas import RecordCanvas
from insonify_viewer.views.record_handles import RecordHandles

PINGS_A_NOTCH = 16
NOTCH = 120  # of the wheel, in eighths of a degree
CLOSER = 1.25  # magnification by a notch
SIDEWAYS = 0.1  # share of the plot by which a notch moves it across
STILL = 3  # px by which the mouse may move in a click


class WaterfallView(RecordCanvas):
    """Draws a record, and signals what the mouse does to it.

    Parameters
    ----------
    native : bool
        Whether the widget owns a native window; beside an OpenGL widget others are drawn several times slower.
    parent : QWidget, optional
        Owner.

    Attributes
    ----------
    measuring : bool
        Whether a drag measures; else it moves a zoomed record, and the record along the tow.
    """

    hovered = Signal(object)  # Mark or None
    scrolled = Signal(int)  # pings further back
    scrubbed = Signal(int)  # ping to put on top
    clicked = Signal(object)  # Mark
    measured = Signal(object, object)  # Marks of both ends of a line

    def __init__(self, *, native: bool = False, parent: QWidget | None = None) -> None:
        super().__init__(native=native, parent=parent)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setCursor(Qt.CursorShape.CrossCursor)
        self.measuring = False
        self.handles = RecordHandles(self.place_of, self.update, self)
        self._pressed: QPoint | None = None
        self._taken: QPoint | None = None  # where a handle was taken
        self._dragged: QPoint | None = None  # where a drag under way has come to
        self._notches = 0.0

    def magnify(self, factor: float, place: QPoint | None = None) -> None:
        """Zoom about a place of the plot, else about its middle."""
        plot = self._plot()
        place = plot.center() if place is None else place
        u = (place.x() - plot.left()) / max(plot.width(), 1)
        v = (place.y() - plot.top()) / max(plot.height(), 1)
        self.show_zoom(self._projection.zoom.about(u, v, factor))

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of the handle, or move it to a place on its rail; or begin a click or a drag."""
        if event.button() is Qt.MouseButton.LeftButton and self._handle.contains(event.position()):
            self._handle.held = True
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
        elif self._handle.held:
            self._handle.held = False
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
        if self._handle.held:
            self._scrub(event)
            return
        if self.handles.held:
            self.handles.pull(self.mark_at(place))
            return
        if self._pressed is not None and (self._dragged or (place - self._pressed).manhattanLength() > STILL):
            self._drag(place)
        on_rail = self._handle.contains(event.position())
        gripped = self.handles.hover(place)
        cross = Qt.CursorShape.SizeAllCursor if gripped else Qt.CursorShape.CrossCursor
        self.setCursor(Qt.CursorShape.SizeVerCursor if on_rail else cross)
        self.setToolTip("Drag to any ping of the tow" if on_rail else gripped)
        self.hovered.emit(self.mark_at(place))

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
        plot, zoom = self._plot(), self._projection.zoom
        u = (before.x() - place.x()) / max(plot.width(), 1)
        v = (before.y() - place.y()) / max(plot.height(), 1)
        moved = zoom.moved(u, v)
        self.show_zoom(moved if moved != zoom else self._zoom)
        wanted = v * (zoom.lower - zoom.upper)
        # The zoom goes no farther; the tow may.
        self._scroll_by((wanted - (moved.upper - zoom.upper)) * self._record.pings)

    def _scrub(self, event: QMouseEvent) -> None:
        self.scrubbed.emit(self._handle.ping_at(event.position()))
        self.update()

    @guard_override(None)
    def leaveEvent(self, event: QEvent) -> None:
        """Signal that the mouse has left."""
        self.hovered.emit(None)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Signal by how many pings to look back; with Ctrl zoom about the mouse, with Shift move across."""
        turned = event.angleDelta().y() or event.angleDelta().x()  # Qt turns the wheel sideways with Alt
        keys, zoom = event.modifiers(), self._projection.zoom
        if keys & Qt.KeyboardModifier.ControlModifier:
            self.magnify(CLOSER ** (turned / NOTCH), event.position().toPoint())
        elif keys & Qt.KeyboardModifier.ShiftModifier:
            self.show_zoom(zoom.moved(-SIDEWAYS * turned / NOTCH, 0.0))
        else:
            self._scroll_by(-turned * PINGS_A_NOTCH / NOTCH)
        event.accept()

    def _scroll_by(self, pings: float) -> None:
        """Move the picture up by some pings, and signal by how many to look back; touchpads send fractions."""
        self._notches += pings if self._look.newest_on_top else -pings
        whole = int(self._notches)
        if whole:
            self._notches -= whole
            self.scrolled.emit(whole)
