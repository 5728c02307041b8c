"""Scale bar, north arrow and bar of depth colours, in a corner of the three-dimensional view."""

import math
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QLinearGradient, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QWidget
from vtkmodules.vtkRenderingCore import vtkActor2D, vtkImageMapper

from insonify_viewer.seabed.bed_shading import depth_palette
from insonify_viewer.seabed.lean_pyvista import pv
from insonify_viewer.widgets.painting import round_steps
from insonify_viewer.widgets.theme import HALO, OVER_WATER, text_scale

WIDE, HIGH, BARS = 236, 84, 150.0  # px at the usual size of the text: of the picture, and the greatest length of a bar
LEFT, LINE, AWAY = 52.0, 20.0, 10  # px: of the bars, of a line of text, from the corner of the view
ARROW = [(0.0, -12.0), (7.0, 12.0), (0.0, 7.0), (-7.0, 12.0)]


class SeabedGuides:
    """A picture over the lower left corner of a view, painted anew when what it shows changes."""

    def __init__(self, plotter: Any, widget: QWidget) -> None:
        self._widget, self.shown = widget, (0.0, 0.0, (0.0, 0.0), 0.0)
        self._mapper = vtkImageMapper()
        self._mapper.SetColorWindow(255.0)
        self._mapper.SetColorLevel(127.5)
        actor = vtkActor2D()
        actor.SetMapper(self._mapper)
        actor.SetPosition(AWAY, AWAY)
        plotter.renderer.AddViewProp(actor)

    def show(self, metres: float, bearing: float, depths: tuple[float, float] | None) -> None:
        """Show metres of a pixel, the bearing of the view from east, rad, and the ends of the colours of depths."""
        ratio = self._widget.devicePixelRatioF()
        shown = float(f"{metres:.2g}"), round(math.degrees(bearing)), depths or (0.0, 0.0), ratio
        if shown == self.shown or not metres > 0.0:
            return
        self.shown, large = shown, text_scale(self._widget)
        image = QImage(round(WIDE * large * ratio), round(HIGH * large * ratio), QImage.Format.Format_RGBA8888)
        image.setDevicePixelRatio(ratio)
        image.fill(Qt.GlobalColor.transparent)
        with QPainter(image) as painter:
            painter.setFont(self._widget.font())
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.scale(large, large)
            font = painter.font()
            font.setPointSizeF(font.pointSizeF() / large)
            painter.setFont(font)
            _paint_north(painter, shown[1])
            _paint_scale(painter, metres)
            if depths is not None:
                _paint_depths(painter, depths)
        rows = np.frombuffer(image.constBits(), dtype=np.uint8).reshape(image.height(), image.bytesPerLine())
        grid = pv.ImageData(dimensions=(image.width(), image.height(), 1))
        pixels = rows[::-1, : 4 * image.width()].reshape(-1, 4)
        grid.point_data["pixels"] = np.ascontiguousarray(pixels)
        grid.point_data.active_scalars_name = "pixels"
        self._mapper.SetInputData(grid)


def _paint_north(painter: QPainter, bearing: float) -> None:
    """Paint an arrow to the north, given the degrees from east in which the view looks."""
    turn, middle = math.radians(bearing - 90.0), QPointF(26.0, HIGH - 28.0)
    painter.save()
    painter.translate(middle)
    painter.rotate(bearing - 90.0)
    painter.setPen(QPen(QColor(HALO), 1.5))
    painter.setBrush(QColor(OVER_WATER))
    painter.drawPolygon(QPolygonF([QPointF(*corner) for corner in ARROW]))
    painter.restore()
    tip = middle + QPointF(math.sin(turn), -math.cos(turn)) * 18.0
    _write(painter, tip.x() - 4.0, tip.y() + 5.0, "N")


def _paint_scale(painter: QPainter, metres: float) -> None:
    """Paint a round length at the focus of the view."""
    length = round_steps(0.0, BARS * metres, 3)[-1]
    bar, base = length / metres, HIGH - 10.0
    for colour, width in ((HALO, 5.0), (OVER_WATER, 2.0)):
        painter.setPen(QPen(QColor(colour), width))
        painter.drawPolyline([QPointF(LEFT + x, base + y) for x, y in ((0, -5), (0, 0), (bar, 0), (bar, -5))])
    _write(painter, LEFT + 6.0, base - 6.0, f"{length:g} m")


def _paint_depths(painter: QPainter, depths: tuple[float, float]) -> None:
    """Paint the colours of the bed from its shallowest to its deepest place."""
    bar = QRectF(LEFT, 6.0, BARS, 10.0)
    colours = QLinearGradient(bar.topLeft(), bar.topRight())
    palette = depth_palette()
    for place in range(0, 256, 15):
        colours.setColorAt(place / 255.0, QColor.fromRgbF(*map(float, palette[255 - place])))
    painter.fillRect(bar, colours)
    digits = 1 if depths[1] - depths[0] >= 1.0 else 2
    _write(painter, LEFT, bar.bottom() + LINE - 4.0, f"depth {depths[0]:.{digits}f} to {depths[1]:.{digits}f} m")


def _write(painter: QPainter, x: float, base: float, words: str) -> None:
    for colour, aside in ((HALO, 1.0), (OVER_WATER, 0.0)):
        painter.setPen(QColor(colour))
        painter.drawText(QPointF(x + aside, base + aside), words)
