"""Painting of a ray diagram in the colours of the window."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen, QPolygonF

from insonify.display.ray_diagram.diagram import RayDiagram, describe_eigenray, place_along_axis
from insonify_viewer.panels.water.view.plot_scales import PlotScales
from insonify_viewer.widgets.pixels import round_steps
from insonify_viewer.widgets.theme import (
    ACCENT,
    ACCENT_IN_WATER,
    GROUND,
    MARK,
    MARK_IN_WATER,
    OVER_WATER,
    QUIET,
    RAISED,
    TEXT,
)

# Colours of sound speed, from slow to fast.
NIGHT = np.array([(28, 70, 108), (38, 62, 84), (62, 59, 56), (106, 80, 46)], dtype=np.float64)
RAY, BED, BED_EDGE, SHADE = "#9cc3e2", "#4b3f2d", "#8a7450", (2, 4, 7, 190)
EIGENRAYS = (ACCENT_IN_WATER, "#7bd389", "#f26d6d", "#c792ea")
DARK, SIGN = "#121a22", QColor(18, 26, 34, 205)  # around marks, and behind words, in the water
ROWS, COLUMNS = 128, 64  # size of the sound-speed picture
LABEL = 34.0  # px, least distance of two angle labels
HANDLE = 4.5  # px, radius of a point that can be dragged


def water_picture(diagram: RayDiagram, slowest: float, fastest: float) -> QImage:
    """Picture of the water, coloured by sound speed."""
    x, depth = np.linspace(0.0, diagram.reach, COLUMNS), np.linspace(0.0, diagram.bottom, ROWS)
    speed = diagram.layers.speed_at(*place_along_axis(diagram.layers, x[None, :]), depth[:, None])
    share = (np.broadcast_to(speed, (ROWS, COLUMNS)) - slowest) / (fastest - slowest)
    places = np.linspace(0.0, 1.0, len(NIGHT))
    return _image(np.stack([np.interp(share, places, tone) for tone in NIGHT.T], axis=-1).astype(np.uint8), "RGB888")


def shadow_picture(diagram: RayDiagram) -> QImage:
    """Picture of the shadow zones, which no direct ray reaches."""
    shade = np.zeros((*diagram.shadow.shape, 4), dtype=np.uint8)
    shade[diagram.shadow] = SHADE
    return _image(shade, "RGBA8888")


def _image(pixels: NDArray[np.uint8], name: str) -> QImage:
    pixels = np.ascontiguousarray(pixels)
    rows, columns, depth = pixels.shape
    return QImage(pixels.data, columns, rows, columns * depth, getattr(QImage.Format, f"Format_{name}")).copy()


def paint_water(painter: QPainter, diagram: RayDiagram, frame: PlotScales, water: QImage, shadow: QImage) -> None:
    """Paint water, rays, bed, labels and scales."""
    painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
    painter.drawImage(frame.water, water)
    painter.drawImage(frame.water, shadow)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setClipRect(frame.rays)
    painter.setPen(_pen(RAY, 1.0, 150))
    for path in diagram.rays:
        painter.drawPolyline(_polygon(frame, path.range, path.depth))
    painter.setPen(_pen(MARK_IN_WATER, 2.0))
    painter.drawPoints(_polygon(frame, *diagram.caustics.T))
    for number, path in enumerate(diagram.eigenrays):
        painter.setPen(_pen(EIGENRAYS[number % len(EIGENRAYS)], 2.4))
        painter.drawPolyline(_polygon(frame, path.range, path.depth))
    painter.setClipping(False)
    _paint_bed(painter, frame, frame.rays)
    painter.setPen(_pen("#000000", 4.0))
    for begin, end in diagram.dark:
        painter.drawLine(frame.at(begin, frame.bottom), frame.at(end, frame.bottom))
    painter.setPen(_pen(DARK, 1.0))
    painter.setBrush(QColor(OVER_WATER))
    painter.drawEllipse(frame.at(0.0, diagram.source_depth), 5.0, 5.0)
    if diagram.target is not None:
        painter.setPen(_pen(OVER_WATER, 1.6))
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
    painter.fillRect(area, RAISED)
    y = frame.height_of(diagram.source_depth)
    painter.setPen(QPen(QColor(QUIET), 1.0, Qt.PenStyle.DashLine))
    painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
    layers = diagram.layers
    within = layers.depth[(layers.depth > 0.0) & (layers.depth < diagram.bottom)]
    depth = np.concatenate([[0.0], within, [diagram.bottom]])
    for number, profile in enumerate(layers.speed):
        share = number / max(len(layers.speed) - 1, 1)
        painter.setPen(_pen(TEXT, 2.0 - share, 255 - int(90 * share)))
        speeds = np.interp(depth, layers.depth, profile)
        painter.drawPolyline(QPolygonF([frame.of_speed(c, d) for c, d in zip(speeds, depth)]))
    _paint_bed(painter, frame, area)
    for number, point in enumerate(points):
        painter.setPen(_pen(GROUND, 1.0))
        painter.setBrush(QColor(ACCENT if number == held else MARK))
        painter.drawEllipse(point, HANDLE, HANDLE)


def _paint_bed(painter: QPainter, frame: PlotScales, area: QRectF) -> None:
    y = frame.height_of(frame.bottom)
    painter.fillRect(QRectF(area.left(), y, area.width(), area.bottom() - y), QColor(BED))
    painter.setPen(_pen(BED_EDGE, 1.0))
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
        painter.setPen(QColor(RAY if on_bed else QUIET))  # all others stand outside the picture
        if leaves:
            painter.drawText(QPointF(end.x() + 3.0, end.y() + 4.0), text)
        elif on_bed:
            painter.drawText(QRectF(end.x() - 30.0, end.y() + 2.0, 60.0, 16.0), Qt.AlignmentFlag.AlignHCenter, text)
        else:
            painter.drawText(QRectF(end.x() - 30.0, end.y() - 18.0, 60.0, 16.0), Qt.AlignmentFlag.AlignHCenter, text)


def _label_scales(painter: QPainter, frame: PlotScales) -> None:
    painter.setPen(QColor(QUIET))
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
    """Describe the eigenrays, and where no sound reaches the bed."""
    lines = [(EIGENRAYS[k % len(EIGENRAYS)], describe_eigenray(path)) for k, path in enumerate(diagram.eigenrays)]
    if diagram.target is not None and not lines:
        lines = [(OVER_WATER, "no direct ray reaches this point: it lies in a shadow zone")]
    for begin, end in diagram.dark:
        place = f"beyond {begin:.1f} m" if end >= diagram.reach else f"from {begin:.1f} to {end:.1f} m"
        lines.append((OVER_WATER, f"no sound on the bed {place}"))
    metrics = painter.fontMetrics()
    for number, (colour, line) in enumerate(lines):
        width = metrics.horizontalAdvance(line) + 10.0
        box = QRectF(frame.rays.right() - width - 4.0, frame.rays.top() + 5.0 + 17.0 * number, width, 16.0)
        painter.fillRect(box, SIGN)
        painter.setPen(QColor(colour))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, line)


def _polygon(frame: PlotScales, distance: NDArray[np.float64], depth: NDArray[np.float64]) -> QPolygonF:
    area = frame.water
    x = area.left() + np.asarray(distance) / frame.reach * area.width()
    y = area.top() + np.asarray(depth) / frame.bottom * area.height()
    return QPolygonF([QPointF(a, b) for a, b in zip(x.tolist(), y.tolist())])


def _pen(colour: QColor | str, width: float, alpha: int = 255) -> QPen:
    mixed = QColor(colour)
    mixed.setAlpha(alpha)
    pen = QPen(mixed, width)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    return pen
