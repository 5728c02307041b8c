"""Sound-speed profile with points to drag, beside the rays that it bends."""

from __future__ import annotations

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import QImage, QMouseEvent, QPainter, QPaintEvent, QPixmap, QResizeEvent
from PySide6.QtWidgets import QWidget

from insonify.display.ray_diagram.diagram import RayDiagram
from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.panels.water.view.painting import paint_profile, paint_water, shadow_picture, water_picture
from insonify_viewer.panels.water.view.plot_scales import PlotScales
from insonify_viewer.views.theme import GROUND, QUIET

GRASP = 9.0  # px, greatest distance at which a point is grasped
HINT = "Drag the points of the profile. Click into the water to find the rays that reach that point."


class WaterView(QWidget):
    """Shows a ray diagram, and signals drags and clicks."""

    point_dragged = Signal(int, float, float)
    point_settled = Signal()
    targeted = Signal(float, float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumHeight(150)
        self.setMouseTracking(True)
        self.setToolTip(HINT)
        self._diagram: RayDiagram | None = None
        self._points: tuple[tuple[float, float], ...] = ()
        self._pictures: tuple[QImage, QImage] | None = None
        self._rays: QPixmap | None = None
        self._held: int | None = None
        self._scale: PlotScales | None = None  # fixed while a point is dragged

    def show_diagram(self, diagram: RayDiagram, points: tuple[tuple[float, float], ...]) -> None:
        """Show a diagram; ``points`` are those of the profile that can be dragged, depth and speed each."""
        self._diagram = diagram
        self._rays = self._pictures = None
        if self._held is None:
            self._scale = None
        self._points = points
        self.update()

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
            paint_profile(painter, self._diagram, frame, points, self._held)

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
            self._scale = frame
        elif frame.rays.contains(place) and frame.range_at(place) > 0.0:
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
