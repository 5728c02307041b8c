"""Sound-speed profile with points to drag, beside the rays that it bends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFocusEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPen,
    QPolygonF,
    QResizeEvent,
)

from insonify.arrays import Floats
from insonify.display.ray_diagram.diagram import RayDiagram, compute_speed_limits, describe_eigenray, place_along_axis
from insonify_viewer.errors import guard_override
from insonify_viewer.record.record_overlays import draw_cross
from insonify_viewer.state.quantities import nearest_within
from insonify_viewer.widgets import theme
from insonify_viewer.widgets.arrow_keys import ENTER, modifiers_of, steps_of
from insonify_viewer.widgets.painting import PaintedOnce, image_of, round_steps, rounded_pen

SPEED, DEPTH = 0.2, 0.1  # m/s and m, by which a key moves a point of the profile
KEY_STEP = 0.01  # of the range and of the depth, by which a key moves the cross in the water
FORTH, BACK = Qt.FocusReason.TabFocusReason, Qt.FocusReason.BacktabFocusReason
GRASP = 9.0  # px, greatest distance at which a point is grasped
HINT = (
    "Drag the points of the sound-speed profile. Click in the water to see which rays reach that place. Keys: Tab "
    "chooses a point or the cross in the water, arrow keys move it, Return finds the rays to the cross."
)
LEFT, GAP, RIGHT, TOP, BOTTOM = 46.0, 14.0, 34.0, 24.0, 30.0  # px around and between the two plots
SHARE, NARROWEST, WIDEST = 0.18, 110.0, 220.0  # of the profile: share of the width, px
BED_SHARE = 0.10  # of the height, filled by the bed
# Colours of sound speed, from slow to fast.
NIGHT = np.array([(28, 70, 108), (38, 62, 84), (62, 59, 56), (106, 80, 46)], dtype=np.float64)
RAY, BED, BED_EDGE, SHADE = "#9cc3e2", "#4b3f2d", "#8a7450", (2, 4, 7, 190)
EIGENRAYS = (theme.ACCENT_IN_WATER, "#7bd389", "#f26d6d", "#c792ea")
DARK, SIGN = "#121a22", QColor(18, 26, 34, 205)  # around marks, and behind words, in the water
ROWS, COLUMNS = 128, 64  # size of the sound-speed picture
LABEL = 34.0  # px, least distance of two angle labels
HANDLE = 4.5  # px, radius of a point that can be dragged


class WaterView(PaintedOnce):
    """Shows a ray diagram, and signals drags and clicks, which keys do as well."""

    # The Tab key goes from point to point of the profile, then to a cross in the water; arrow keys move what is
    # chosen.

    point_dragged = Signal(int, float, float)
    point_settled = Signal()
    targeted = Signal(float, float)

    def __init__(self) -> None:
        super().__init__(minimumHeight=150, mouseTracking=True, focusPolicy=Qt.FocusPolicy.StrongFocus, toolTip=HINT)
        self.setAccessibleName("Sound speed over depth, beside the rays")
        self._diagram: RayDiagram | None = None
        self.points: tuple[tuple[float, float], ...] = ()
        self.newest: tuple[tuple[float, float], ...] = ()  # of the present profile, whose rays may still be traced
        self._pictures: tuple[QImage, QImage] | None = None
        self._held: int | None = None
        self._scale: PlotScales | None = None  # fixed while a point is dragged or moved by a key
        self._chosen = 0  # point that keys move; their number stands for the cross in the water
        self._cross = (0.5, 0.5)  # shares of range and depth
        self._moved = False  # whether a key that is down has moved a point

    def show_diagram(self, diagram: RayDiagram, points: tuple[tuple[float, float], ...]) -> None:
        """Show a diagram; ``points`` are those of the profile that can be dragged, depth and speed each."""
        self._diagram = diagram
        self._pictures = None
        if self._held is None and not self._moved:
            self._scale = None
        self.points = points
        self.paint_anew()

    def paint(self, painter: QPainter) -> None:
        """Paint the rays once, and the profile every time."""
        if self._diagram is None:
            painter.setPen(theme.QUIET)
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "tracing rays …")
            return
        frame = self.scales()
        super().paint(painter)
        points = [frame.of_speed(speed, depth) for depth, speed in self.points if depth <= frame.bottom]
        chosen = min(self._chosen, len(points)) if self.hasFocus() else None
        paint_profile(painter, self._diagram, frame, points, chosen if self._held is None else self._held)
        if chosen == len(points):
            draw_cross(painter, self.scales().at(*self._aim()).toPoint())

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the rays to the new size."""
        self._scale = None
        super().resizeEvent(event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Grasp a point of the profile, or signal a point of the water."""
        if self._diagram is None or event.button() != Qt.MouseButton.LeftButton:
            return
        place, frame = event.position(), self.scales()
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
            frame = self.scales()
            self.point_dragged.emit(self._held, frame.depth_at(event.position()), frame.speed_at(event.position()))
        elif self._diagram is not None:
            over = self._point_under(event.position()) is not None
            self.setCursor(Qt.CursorShape.OpenHandCursor if over else Qt.CursorShape.ArrowCursor)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Release the grasped point."""
        if self._held is not None:
            self._held = self._scale = None
            self.point_settled.emit()
            self.paint_anew()

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
        """Settle the point that a pressed key still moves."""
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
        return sum(depth <= bottom for depth, _ in self.points)

    def _aim(self) -> tuple[float, float]:
        """Range and depth of the cross in the water, in metres."""
        frame = self.scales()
        return self._cross[0] * frame.reach, self._cross[1] * frame.bottom

    def _choose(self, chosen: int) -> None:
        self._settle()
        self._chosen = chosen
        self.update()

    def _move(self, across: int, down: int) -> None:
        """Move the chosen point of the profile, or the cross, by some steps."""
        if self._chosen >= self._in_water:
            distance, depth = self._cross[0] + KEY_STEP * across, self._cross[1] + KEY_STEP * down
            self._cross = min(max(distance, KEY_STEP), 1.0), min(max(depth, 0.0), 1.0)
            self.update()
        elif self._chosen < len(self.newest):
            frame, (depth, speed) = self.scales(), self.newest[self._chosen]
            self._scale, self._moved = frame, True
            depth = min(max(depth + DEPTH * down, 0.0), frame.bottom)
            self.point_dragged.emit(self._chosen, depth, speed + SPEED * across)

    def _settle(self) -> None:
        if self._moved:
            self._moved, self._scale = False, None
            self.point_settled.emit()
            self.paint_anew()

    def _point_under(self, place: QPointF) -> int | None:
        """Nearest point of the profile within grasp."""
        frame = self.scales()
        distances = [
            (place - frame.of_speed(speed, depth)).manhattanLength() if depth <= frame.bottom else float("inf")
            for depth, speed in self.points
        ]
        return nearest_within(distances, GRASP)

    def scales(self) -> PlotScales:
        """Scales of the plots, which stay while a point is moved."""
        assert self._diagram is not None
        return self._scale or PlotScales.of(self._diagram, self.width(), self.height())

    def paint_picture(self, painter: QPainter) -> None:
        """Paint the rays."""
        assert self._diagram is not None
        frame = self.scales()
        if self._pictures is None:
            self._pictures = water_picture(self._diagram, frame.slowest, frame.fastest), shadow_picture(self._diagram)
        paint_water(painter, self._diagram, frame, *self._pictures)


@dataclass(frozen=True)
class PlotScales:
    """Scales of the two plots, with a common depth axis."""

    profile: QRectF  # rectangles of the plots, with the bed, in pixels
    rays: QRectF
    slowest: float  # ends of the profile's scale, in m/s
    fastest: float
    bottom: float  # depth of the mean bed and greatest range, in metres
    reach: float

    @classmethod
    def of(cls, diagram: RayDiagram, width: float, height: float) -> PlotScales:
        """Fit a diagram into a widget of a width and height in pixels."""
        narrow = min(max(SHARE * width, NARROWEST), WIDEST)
        tall = max(height - TOP - BOTTOM, 1.0)
        begin = LEFT + narrow + GAP
        return cls(
            QRectF(LEFT, TOP, narrow, tall),
            QRectF(begin, TOP, max(width - begin - RIGHT, 1.0), tall),
            *compute_speed_limits(diagram),
            diagram.bottom,
            diagram.reach,
        )

    @property
    def water(self) -> QRectF:
        """The plot of the rays without the bed."""
        return QRectF(self.rays.left(), self.rays.top(), self.rays.width(), (1.0 - BED_SHARE) * self.rays.height())

    def height_of(self, depth: float) -> float:
        """Pixel of a depth in metres."""
        return self.water.top() + depth / self.bottom * self.water.height()

    def at(self, distance: float, depth: float) -> QPointF:
        """Pixel of a range and a depth in metres."""
        return QPointF(self.rays.left() + distance / self.reach * self.rays.width(), self.height_of(depth))

    def of_speed(self, speed: float, depth: float) -> QPointF:
        """Pixel of a speed of sound in m/s at a depth in metres."""
        share = (speed - self.slowest) / (self.fastest - self.slowest)
        return QPointF(self.profile.left() + share * self.profile.width(), self.height_of(depth))

    def depth_at(self, place: QPointF) -> float:
        """Depth of a pixel in metres, within the water."""
        depth = (place.y() - self.water.top()) / self.water.height() * self.bottom
        return min(max(depth, 0.0), self.bottom)

    def range_at(self, place: QPointF) -> float:
        """Range of a pixel in metres."""
        return (place.x() - self.rays.left()) / self.rays.width() * self.reach

    def speed_at(self, place: QPointF) -> float:
        """Speed of sound of a pixel in m/s."""
        share = (place.x() - self.profile.left()) / self.profile.width()
        return self.slowest + share * (self.fastest - self.slowest)


def water_picture(diagram: RayDiagram, slowest: float, fastest: float) -> QImage:
    """Picture of the water, coloured by sound speed."""
    x, depth = np.linspace(0.0, diagram.reach, COLUMNS), np.linspace(0.0, diagram.bottom, ROWS)
    speed = diagram.layers.speed_at(*place_along_axis(diagram.layers, x[None, :]), depth[:, None])
    share = (np.broadcast_to(speed, (ROWS, COLUMNS)) - slowest) / (fastest - slowest)
    places = np.linspace(0.0, 1.0, len(NIGHT))
    return image_of(np.stack([np.interp(share, places, tone) for tone in NIGHT.T], axis=-1).astype(np.uint8))


def shadow_picture(diagram: RayDiagram) -> QImage:
    """Picture of the shadow zones, which no direct ray reaches."""
    shade = np.zeros((*diagram.shadow.shape, 4), dtype=np.uint8)
    shade[diagram.shadow] = SHADE
    return image_of(shade)


def paint_water(painter: QPainter, diagram: RayDiagram, frame: PlotScales, water: QImage, shadow: QImage) -> None:
    """Paint water, rays, bed, labels and scales."""
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    painter.drawImage(frame.water, water)
    painter.drawImage(frame.water, shadow)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setClipRect(frame.rays)
    painter.setPen(rounded_pen(RAY, 1.0, 150))
    for path in diagram.rays:
        painter.drawPolyline(_polygon(frame, path.range, path.depth))
    painter.setPen(rounded_pen(theme.MARK_IN_WATER, 2.0))
    painter.drawPoints(_polygon(frame, *diagram.caustics.T))
    for number, path in enumerate(diagram.eigenrays):
        painter.setPen(rounded_pen(EIGENRAYS[number % len(EIGENRAYS)], 2.4))
        painter.drawPolyline(_polygon(frame, path.range, path.depth))
    painter.setClipping(False)
    _paint_bed(painter, frame, frame.rays)
    painter.setPen(rounded_pen("#000000", 4.0))
    for begin, end in diagram.dark:
        painter.drawLine(frame.at(begin, frame.bottom), frame.at(end, frame.bottom))
    painter.setPen(rounded_pen(DARK, 1.0))
    painter.setBrush(QColor(theme.OVER_WATER))
    painter.drawEllipse(frame.at(0.0, diagram.source_depth), 5.0, 5.0)
    if diagram.target is not None:
        painter.setPen(rounded_pen(theme.OVER_WATER, 1.6))
        painter.setBrush(QColor(DARK))
        painter.drawEllipse(frame.at(*diagram.target), 4.5, 4.5)
    _label_rays(painter, diagram, frame)
    _label_scales(painter, frame)
    _say(painter, diagram, frame)


def paint_profile(
    painter: QPainter, diagram: RayDiagram, frame: PlotScales, points: list[QPointF], held: int | None
) -> None:
    """Paint sound speed over depth, with the points that can be dragged."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    area = frame.profile
    painter.fillRect(area, theme.RAISED)
    y = frame.height_of(diagram.source_depth)
    painter.setPen(QPen(QColor(theme.QUIET), 1.0, Qt.PenStyle.DashLine))
    painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
    layers = diagram.layers
    within = layers.depth[(layers.depth > 0.0) & (layers.depth < diagram.bottom)]
    depth = np.concatenate([[0.0], within, [diagram.bottom]])
    for number, profile in enumerate(layers.speed):
        share = number / max(len(layers.speed) - 1, 1)
        painter.setPen(rounded_pen(theme.TEXT, 2.0 - share, 255 - int(90 * share)))
        speeds = np.interp(depth, layers.depth, profile)
        painter.drawPolyline(QPolygonF([frame.of_speed(c, d) for c, d in zip(speeds, depth)]))
    _paint_bed(painter, frame, area)
    for number, point in enumerate(points):
        painter.setPen(rounded_pen(theme.GROUND, 1.0))
        painter.setBrush(QColor(theme.ACCENT if number == held else theme.MARK))
        painter.drawEllipse(point, HANDLE, HANDLE)


def _paint_bed(painter: QPainter, frame: PlotScales, area: QRectF) -> None:
    y = frame.height_of(frame.bottom)
    painter.fillRect(QRectF(area.left(), y, area.width(), area.bottom() - y), QColor(BED))
    painter.setPen(rounded_pen(BED_EDGE, 1.0))
    painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))


def _label_rays(painter: QPainter, diagram: RayDiagram, frame: PlotScales) -> None:
    """Label ray ends with launch angles, the roundest first, where there is room."""
    taken: list[QPointF] = []
    by_roundness = sorted(diagram.rays, key=lambda path: (path.angle % 10.0 != 0.0, path.angle % 5.0 != 0.0))
    for path in by_roundness:
        end = frame.at(path.range[-1], path.depth[-1])
        if any(abs(end.x() - other.x()) < LABEL and abs(end.y() - other.y()) < 0.6 * LABEL for other in taken):
            continue
        taken.append(end)
        text = f"{path.angle:.3g}°".replace("-", "−")
        leaves = path.range[-1] >= diagram.reach * (1.0 - 1e-9)
        on_bed = not leaves and path.depth[-1] > 0.5 * diagram.bottom
        painter.setPen(QColor(RAY if on_bed else theme.QUIET))  # all others stand outside the picture
        if leaves:
            painter.drawText(QPointF(end.x() + 3.0, end.y() + 4.0), text)
        elif on_bed:
            painter.drawText(QRectF(end.x() - 30.0, end.y() + 2.0, 60.0, 16.0), Qt.AlignmentFlag.AlignHCenter, text)
        else:
            painter.drawText(QRectF(end.x() - 30.0, end.y() - 18.0, 60.0, 16.0), Qt.AlignmentFlag.AlignHCenter, text)


def _label_scales(painter: QPainter, frame: PlotScales) -> None:
    painter.setPen(QColor(theme.QUIET))
    right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
    for depth in round_steps(0.0, frame.bottom, 5):
        y = frame.height_of(depth)
        painter.drawText(QRectF(0.0, y - 8.0, frame.profile.left() - 6.0, 16.0), right, f"{depth:g} m")
    middle = Qt.AlignmentFlag.AlignHCenter
    y = frame.rays.bottom() + 4.0
    for distance in round_steps(0.0, frame.reach, 8)[1:]:
        x = frame.at(distance, 0.0).x()
        painter.drawText(QRectF(x - 40.0, y, 80.0, 16.0), middle, f"{distance:g} m")
    for speed in round_steps(frame.slowest, frame.fastest, 3):
        x = frame.of_speed(speed, 0.0).x()
        painter.drawText(QRectF(x - 40.0, y, 80.0, 16.0), middle, f"{speed:g}")
    # Above the profile: below it the ends of the scale leave no room.
    painter.drawText(QRectF(frame.profile.left(), 4.0, frame.profile.width(), 16.0), middle, "m/s")


def _say(painter: QPainter, diagram: RayDiagram, frame: PlotScales) -> None:
    """Describe the eigenrays, where no sound reaches the bed, and formulas beyond their range."""
    lines = [(EIGENRAYS[k % len(EIGENRAYS)], describe_eigenray(path)) for k, path in enumerate(diagram.eigenrays)]
    if diagram.target is not None and not lines:
        lines = [(theme.OVER_WATER, "no direct ray reaches this point: it lies in a shadow zone")]
    for begin, end in diagram.dark:
        place = f"beyond {begin:.1f} m" if end >= diagram.reach else f"from {begin:.1f} to {end:.1f} m"
        lines.append((theme.OVER_WATER, f"no sound on the bed {place}"))
    lines += [(theme.OVER_WATER, sentence) for sentence in diagram.limits]
    top, flags = frame.rays.top() + 5.0, Qt.AlignmentFlag.AlignRight | Qt.TextFlag.TextWordWrap
    for colour, line in lines:
        room = QRectF(frame.rays.left() + 9.0, top, frame.rays.width() - 18.0, frame.rays.height())
        box = painter.boundingRect(room, flags, line)
        painter.fillRect(box.adjusted(-5.0, 0.0, 5.0, 0.0), SIGN)
        painter.setPen(QColor(colour))
        painter.drawText(box, flags, line)
        top = box.bottom() + 1.0


def _polygon(frame: PlotScales, distance: Floats, depth: Floats) -> QPolygonF:
    area = frame.water
    x = area.left() + np.asarray(distance) / frame.reach * area.width()
    y = area.top() + np.asarray(depth) / frame.bottom * area.height()
    return QPolygonF([QPointF(a, b) for a, b in zip(x.tolist(), y.tolist())])
