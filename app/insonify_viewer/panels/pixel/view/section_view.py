"""Cross-section of the scene in the plane of the beam: bed, targets, what is heard and hidden, rays of a pixel."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen, QPixmap, QResizeEvent
from PySide6.QtWidgets import QWidget

from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.panels.pixel.view.section_scales import SectionScales
from insonify_viewer.widgets.pixels import round_steps
from insonify_viewer.widgets.text_scale import text_scale
from insonify_viewer.widgets.theme import ACCENT_IN_WATER, GROUND, MARK_IN_WATER, OVER_WATER, QUIET

if TYPE_CHECKING:
    from insonify.explanation.cross_section import CrossSection
    from insonify.explanation.pixel import PixelExplanation

WATER, BED, HEARD, HIDDEN = "#1c3a52", "#4b3f2d", ACCENT_IN_WATER, "#0a0604"
BLOCKED, RING, TARGET = "#ff7a5c", "#5b7d99", "#e8eef2"
ARC = 96  # points of the ring of equal slant range

Points = NDArray[np.float64]


class SectionView(QWidget):
    """Paints a cross-section with the rays of a pixel."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setMinimumSize(100, 110)
        self.setAccessibleName("Cross-section of the beam")
        self._shown: tuple[PixelExplanation, CrossSection] | None = None
        self._picture: QPixmap | None = None

    def show_section(self, explanation: PixelExplanation | None, section: CrossSection | None) -> None:
        """Show a pixel in its cross-section; None clears it."""
        self._shown = None if explanation is None or section is None else (explanation, section)
        self._picture = None
        self.update()

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the section to the new size."""
        self._picture = None
        super().resizeEvent(event)

    @guard_override(None)
    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the section once for its size."""
        del event
        if self._picture is None:
            self._picture = self._painted()
        with QPainter(self) as painter:
            painter.drawPixmap(0, 0, self._picture)

    @guard_override(None)
    def changeEvent(self, event: QEvent) -> None:
        """Paint anew in another theme."""
        if event.type() is QEvent.Type.PaletteChange:
            self._picture = None
        super().changeEvent(event)

    def _painted(self) -> QPixmap:
        ratio = self.devicePixelRatioF()
        picture = QPixmap(int(self.width() * ratio), int(self.height() * ratio))
        picture.setDevicePixelRatio(ratio)
        picture.fill(QColor(GROUND))
        if self._shown is not None:
            with QPainter(picture) as painter:
                painter.setFont(self.font())
                painter.setRenderHint(QPainter.RenderHint.Antialiasing)
                _paint(painter, *self._shown, (self.width(), self.height()), text_scale(self))
        return picture


def _paint(
    painter: QPainter, explanation: PixelExplanation, section: CrossSection, size: tuple[int, int], text: float
) -> None:
    """Paint water, bed, targets, rays and scales."""
    ghosts = any(each.path != "direct" for each in explanation.contributions)
    scales = SectionScales.of(section, size, surfaced=ghosts, text=text)
    painter.fillRect(scales.area, QColor(WATER))
    painter.setClipRect(scales.area)
    _paint_bed(painter, scales, section)
    _paint_ring(painter, scales, section, explanation.slant_range)
    _paint_rays(painter, scales, section, explanation)
    painter.setClipping(False)
    painter.setPen(_pen(HIDDEN, 1.0))
    painter.setBrush(QColor(OVER_WATER))
    painter.drawEllipse(scales.at(0.0, float(section.sonar.place[2])), 5.0, 5.0)
    _paint_scales(painter, scales, section)


def _paint_bed(painter: QPainter, scales: SectionScales, section: CrossSection) -> None:
    """Paint the bed with its heard and hidden stretches, horizons and targets."""
    bed = section.bed[np.isfinite(section.bed[:, 1])]
    if len(bed):
        ends = np.array([[bed[-1, 0], scales.low], [bed[0, 0], scales.low]])
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(BED))
        painter.drawPolygon(scales.polygon(np.concatenate([bed, ends])))
    painter.setBrush(Qt.BrushStyle.NoBrush)
    painter.setPen(QPen(QColor(RING), 1.0, Qt.PenStyle.DotLine))
    painter.drawLines(_lines(scales, section.horizon))
    for stretches, colour, width in ((section.heard, HEARD, 2.0), (section.hidden, HIDDEN, 3.5)):
        painter.setPen(_pen(colour, width))
        painter.drawLines(_lines(scales, stretches))
    for name, face in section.targets:
        painter.setPen(_pen(TARGET, 2.5))
        painter.drawLines(_lines(scales, face))
        _name_target(painter, scales, name, face)


def _name_target(painter: QPainter, scales: SectionScales, name: str, face: Points) -> None:
    """Write the name of a target above it and beyond, where the ray from the sonar does not cross it."""
    top = face.reshape(-1, 2)[np.argmax(face[..., 1])]
    place = scales.at(float(top[0]), float(top[1]))
    width = painter.fontMetrics().horizontalAdvance(name) + 2.0
    left = place.x() - 6.0 - width if scales.mirrored else place.x() + 6.0
    left = min(max(left, scales.area.left()), scales.area.right() - width)
    painter.setPen(QColor(TARGET))
    top_left = QPointF(left, place.y() - 20.0 * scales.text)
    painter.drawText(QRectF(top_left, QSizeF(width, 16.0 * scales.text)), Qt.TextFlag.TextDontClip, name)


def _paint_ring(painter: QPainter, scales: SectionScales, section: CrossSection, slant_range: float) -> None:
    """Paint the places at the slant range of the pixel, were sound to go straight."""
    angle = np.linspace(-0.5 * np.pi, 0.0, ARC)
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * slant_range + [0.0, section.sonar.place[2]]
    painter.setPen(QPen(QColor(RING), 1.0, Qt.PenStyle.DashLine))
    painter.drawPolyline(scales.polygon(ring))


def _paint_rays(painter: QPainter, scales: SectionScales, section: CrossSection, explanation: PixelExplanation) -> None:
    """Paint rays, and where they lead."""
    drawn: list[tuple[str, tuple[Points, ...], Points]] = [
        (BLOCKED, each.rays[:1], each.places) for each in explanation.obstructions
    ]
    drawn += [(MARK_IN_WATER, each.rays, each.places) for each in explanation.contributions]
    for colour, rays, places in drawn:
        painter.setPen(_pen(colour, 1.6))
        for ray in rays:
            painter.drawPolyline(scales.polygon(_flat(section, ray)))
        painter.setPen(_pen(colour, 4.0))
        painter.drawLines(_lines(scales, np.stack([_flat(section, place) for place in places])) if len(places) else [])


def _paint_scales(painter: QPainter, scales: SectionScales, section: CrossSection) -> None:
    """Write ground ranges below and depths beside the section."""
    painter.setPen(QColor(QUIET))
    area, wide, high = scales.area, 80.0 * scales.text, 16.0 * scales.text
    for distance in round_steps(0.0, scales.reach, max(int(area.width() / (70 * scales.text)), 1)):
        x = scales.at(distance, 0.0).x()
        place = QRectF(x - 0.5 * wide, area.bottom() + 3.0, wide, high)
        painter.drawText(place, Qt.AlignmentFlag.AlignHCenter, f"{distance:g} m")
    right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
    surface = section.sonar.surface
    for depth in round_steps(
        surface - scales.high, surface - scales.low, max(int(area.height() / (40 * scales.text)), 1)
    ):
        y = scales.at(0.0, surface - depth).y()
        if area.top() <= y <= area.bottom():
            painter.drawText(QRectF(0.0, y - 0.5 * high, area.left() - 6.0, high), right, f"{depth:g} m")


def _flat(section: CrossSection, points: Points) -> Points:
    """Ground range and height of places in local coordinates, (n, 3) to (n, 2)."""
    level = points[:, :2] - section.sonar.place[:2]
    return np.column_stack([np.hypot(level[:, 0], level[:, 1]), points[:, 2]])


def _lines(scales: SectionScales, segments: Points) -> list[QPointF]:
    """Pixels of the beginnings and ends of segments, in turns."""
    return [scales.at(x, z) for x, z in segments.reshape(-1, 2).tolist()]


def _pen(colour: str, width: float) -> QPen:
    pen = QPen(QColor(colour), width)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    return pen
