"""Sound-speed profile with points to drag, beside the rays that it bends."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import (
    QFocusEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPixmap,
    QResizeEvent,
)
from PySide6.QtWidgets import QWidget

from insonify.display.ray_diagram.diagram import RayDiagram
from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.panels.water.view.painting import paint_profile, paint_water, shadow_picture, water_picture
from insonify_viewer.panels.water.view.plot_scales import PlotScales
from insonify_viewer.record.record_overlays import draw_cross
from insonify_viewer.widgets.arrow_keys import ENTER, modifiers_of, steps_of
from insonify_viewer.widgets.theme import GROUND, QUIET

SPEED, DEPTH = 0.2, 0.1  # m/s and m, by which a key moves a point of the profile
SHARE = 0.01  # of the range and of the depth, by which a key moves the cross in the water
FORTH, BACK = Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason
GRASP = 9.0  # px, greatest distance at which a point is grasped
HINT = (
    "Drag the points of the profile. Click into the water to find the rays that reach that point. By keys, Tab goes "
    "from point to point and into the water, arrow keys move what is chosen, and Return finds the rays."
)


class WaterView(QWidget):
    """Shows a ray diagram, and signals drags and clicks, which keys do as well.

    The Tab key goes from point to point of the profile, then to a cross in the water; arrow keys move what is chosen.
    """

    point_dragged = Signal(int, float, float)
    point_settled = Signal()
    targeted = Signal(float, float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumHeight(150)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAccessibleName("Sound speed over depth, beside the rays")
        self.setToolTip(HINT)
        self._diagram: RayDiagram | None = None
        self._points: tuple[tuple[float, float], ...] = ()
        self._newest: tuple[tuple[float, float], ...] = ()
        self._pictures: tuple[QImage, QImage] | None = None
        self._rays: QPixmap | None = None
        self._held: int | None = None
        self._scale: PlotScales | None = None  # fixed while a point is dragged or moved by a key
        self._chosen = 0  # point that keys move; their number stands for the cross in the water
        self._cross = (0.5, 0.5)  # shares of range and depth
        self._moved = False  # whether a key that is down has moved a point

    def show_diagram(self, diagram: RayDiagram, points: tuple[tuple[float, float], ...]) -> None:
        """Show a diagram; ``points`` are those of the profile that can be dragged, depth and speed each."""
        self._diagram = diagram
        self._rays = self._pictures = None
        if self._held is None and not self._moved:
            self._scale = None
        self._points = points
        self.update()

    def follow_points(self, points: tuple[tuple[float, float], ...]) -> None:
        """Note the points of the present profile, whose rays may still be traced; keys move these."""
        self._newest = points

    def place_of(self, distance: float, depth: float) -> QPointF:
        """Pixel of a range and a depth in metres."""
        return self._frame().at(distance, depth)

    def handle(self, number: int) -> QPointF:
        """Pixel of a point of the profile that can be dragged."""
        depth, speed = self._points[number]
        return self._frame().of_speed(speed, depth)

    @guard_override(None)
    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the rays once, and the profile every time."""
        del event
        with QPainter(self) as painter:
            if self._diagram is None:
                painter.setPen(QUIET)
                painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "tracing rays …")
                return
            frame = self._frame()
            if self._rays is None:
                self._rays = self._painted(self._diagram, frame)
            painter.drawPixmap(0, 0, self._rays)
            points = [frame.of_speed(speed, depth) for depth, speed in self._points if depth <= frame.bottom]
            chosen = min(self._chosen, len(points)) if self.hasFocus() else None
            paint_profile(painter, self._diagram, frame, points, chosen if self._held is None else self._held)
            if chosen == len(points):
                draw_cross(painter, self._frame().at(*self._aim()).toPoint())

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the rays to the new size."""
        self._rays = self._scale = None
        super().resizeEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Grasp a point of the profile, or signal a point of the water."""
        if self._diagram is None or event.button() != Qt.MouseButton.LeftButton:
            return
        place, frame = event.position(), self._frame()
        self._held = self._point_under(place)
        if self._held is not None:
            self._scale, self._chosen = frame, self._held
        elif frame.rays.contains(place) and frame.range_at(place) > 0.0:
            self._chosen = self._in_water
            self._cross = frame.range_at(place) / frame.reach, frame.depth_at(place) / frame.bottom
            self.targeted.emit(frame.range_at(place), frame.depth_at(place))
        self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the grasped point; change the cursor over others."""
        if self._held is not None:
            frame = self._frame()
            self.point_dragged.emit(self._held, frame.depth_at(event.position()), frame.speed_at(event.position()))
        elif self._diagram is not None:
            over = self._point_under(event.position()) is not None
            self.setCursor(Qt.CursorShape.OpenHandCursor if over else Qt.CursorShape.ArrowCursor)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Release the grasped point."""
        del event
        if self._held is not None:
            self._held = self._scale = None
            self._rays = None
            self.point_settled.emit()
            self.update()

    @guard_override(False)
    def focusNextPrevChild(self, forth: bool) -> bool:
        """Choose the next point of the profile, or the cross in the water, before the keyboard goes elsewhere."""
        chosen = self._chosen + (1 if forth else -1)
        if self._diagram is None or not 0 <= chosen <= self._in_water:
            return super().focusNextPrevChild(forth)
        self._choose(chosen)
        return True

    @guard_override(None)
    def focusInEvent(self, event: QFocusEvent) -> None:
        """Begin at the end of the points from which the Tab key comes."""
        super().focusInEvent(event)
        ends = {FORTH: 0, BACK: self._in_water}
        self._choose(min(ends.get(event.reason(), self._chosen), self._in_water))

    @guard_override(None)
    def focusOutEvent(self, event: QFocusEvent) -> None:
        """Settle a point whose key is still down."""
        self._settle()
        super().focusOutEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the chosen point or the cross, or signal the point of the water at the cross."""
        steps = steps_of(event)
        if self._diagram is not None and steps is not None:
            self._move(*steps)
        elif self._diagram is not None and event.key() in ENTER and not modifiers_of(event):
            self._choose(self._in_water)
            self.targeted.emit(*self._aim())
        else:
            super().keyPressEvent(event)

    def keyReleaseEvent(self, event: QKeyEvent) -> None:
        """Settle a point that a key has moved, once, however long the key was held."""
        if not event.isAutoRepeat():
            self._settle()
        super().keyReleaseEvent(event)

    @property
    def _in_water(self) -> int:
        """Number of points in sight, which stands for the cross in the water."""
        bottom = 0.0 if self._diagram is None else self._diagram.bottom
        return sum(depth <= bottom for depth, _ in self._points)

    def _aim(self) -> tuple[float, float]:
        """Range and depth of the cross in the water, in metres."""
        frame = self._frame()
        return self._cross[0] * frame.reach, self._cross[1] * frame.bottom

    def _choose(self, chosen: int) -> None:
        self._settle()
        self._chosen = chosen
        self.update()

    def _move(self, across: int, down: int) -> None:
        """Move the chosen point of the profile, or the cross, by some steps."""
        if self._chosen >= self._in_water:
            distance, depth = self._cross[0] + SHARE * across, self._cross[1] + SHARE * down
            self._cross = min(max(distance, SHARE), 1.0), min(max(depth, 0.0), 1.0)
            self.update()
        elif self._chosen < len(self._newest):
            frame, (depth, speed) = self._frame(), self._newest[self._chosen]
            self._scale, self._moved = frame, True
            depth = min(max(depth + DEPTH * down, 0.0), frame.bottom)
            self.point_dragged.emit(self._chosen, depth, speed + SPEED * across)

    def _settle(self) -> None:
        if self._moved:
            self._moved, self._scale, self._rays = False, None, None
            self.point_settled.emit()
            self.update()

    def _point_under(self, place: QPointF) -> int | None:
        """Nearest point of the profile within grasp."""
        frame = self._frame()
        distances = [
            (place - frame.of_speed(speed, depth)).manhattanLength() if depth <= frame.bottom else float("inf")
            for depth, speed in self._points
        ]
        nearest = min(range(len(distances)), key=distances.__getitem__, default=None)
        return nearest if nearest is not None and distances[nearest] <= GRASP else None

    def _frame(self) -> PlotScales:
        assert self._diagram is not None
        return self._scale or PlotScales.of(self._diagram, self.width(), self.height())

    @guard_override(None)
    def changeEvent(self, event: QEvent) -> None:
        """Paint anew in another theme."""
        if event.type() is QEvent.Type.PaletteChange:
            self._rays = None
        super().changeEvent(event)

    def _painted(self, diagram: RayDiagram, frame: PlotScales) -> QPixmap:
        if self._pictures is None:
            self._pictures = water_picture(diagram, frame.slowest, frame.fastest), shadow_picture(diagram)
        ratio = self.devicePixelRatioF()
        pixmap = QPixmap(round(self.width() * ratio), round(self.height() * ratio))
        pixmap.setDevicePixelRatio(ratio)
        pixmap.fill(GROUND)
        with QPainter(pixmap) as painter:
            painter.setFont(self.font())
            paint_water(painter, diagram, frame, *self._pictures)
        return pixmap
