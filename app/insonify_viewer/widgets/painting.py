"""Widgets that keep their picture, colour tables, polylines, marks and round values for rulers."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen, QPolygonF
from PySide6.QtWidgets import QWidget
from shiboken6 import VoidPtr

from insonify.arrays import Bytes, Reals, Singles
from insonify_viewer.errors import guard_override
from insonify_viewer.widgets.theme import ACCENT, GROUND, HALO, MARK, MARK_IN_WATER

KNEE = 0.75  # tone up to which tones are linear
HEADROOM = 24  # times the upper level that takes the last colour: 28 dB
POINT = 16  # bytes of a QPointF, two doubles
wrap_memory: Any = VoidPtr  # its types leave out that it makes a writable buffer of an object
RING, DOT = 7.0, 3.0  # px
FORMATS = {1: QImage.Format.Format_Grayscale8, 3: QImage.Format.Format_RGB888, 4: QImage.Format.Format_RGBA8888}
LIT = "#ff5fd2"  # distinct from the mark and from every palette


class Painted(QWidget):
    """A widget with one method that paints it, and properties of a widget by name."""

    def __init__(self, parent: QWidget | None = None, **properties: Any) -> None:
        super().__init__(parent, **properties)

    def paint(self, painter: QPainter) -> None:
        """Paint the widget as it is now."""
        raise NotImplementedError

    @guard_override(None)
    def paintEvent(self, _event: QPaintEvent) -> None:
        """Paint with a painter of the widget."""
        with QPainter(self) as painter:
            self.paint(painter)


def column_means(amplitude: Singles, width: int) -> Singles:
    """Average bins into display columns, or repeat them where there are more columns than bins."""
    bins = amplitude.shape[1]
    edges = np.arange(width + 1) * bins // width
    if width >= bins:
        return np.ascontiguousarray(amplitude[:, edges[:-1]])
    sums = np.add.reduceat(amplitude, edges[:-1], axis=1)
    return np.asarray(sums / np.diff(edges).astype(np.float32), dtype=np.float32)


def compress_highlights(tone: Singles) -> Singles:
    """Tones of amplitudes between the two levels (0 and 1) and beyond, from 0 to 1."""
    # Up to `KNEE` they stay as they are. Beyond, they grow with the logarithm up to `HEADROOM` times the upper level,
    # so that a target far above the bed keeps its highlights apart.
    above = np.maximum((tone - np.float32(KNEE)) / np.float32(1.0 - KNEE), 0.0)
    most = math.log1p((HEADROOM - KNEE) / (1.0 - KNEE))
    curved = KNEE + (1.0 - KNEE) * np.log1p(above) / most
    return np.asarray(np.where(above > 0.0, np.minimum(curved, 1.0), np.maximum(tone, 0.0)), dtype=np.float32)


def colour_table(palette: Bytes) -> NDArray[np.uint32]:
    """Pack a palette of (256, 3) bytes into (256,) words 0xffRRGGBB."""
    red, green, blue = palette.astype(np.uint32).T
    return np.asarray(0xFF000000 | red << 16 | green << 8 | blue, dtype=np.uint32)


def with_highlights(table: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Extend a table of 256 colours to tones up to `HEADROOM`, with the highlights compressed into it."""
    tones = compress_highlights(np.arange(255 * HEADROOM + 1, dtype=np.float32) / np.float32(255.0))
    return np.asarray(table[np.floor(255.0 * tones + 1e-3).astype(np.int64)])


def dimmed(words: NDArray[np.uint32]) -> NDArray[np.uint32]:
    """Colours 0xffRRGGBB at 3/8 of their brightness."""
    quarter, eighth = (words >> 2) & 0x3F3F3F, (words >> 3) & 0x1F1F1F
    return np.asarray(0xFF000000 | (quarter + eighth), dtype=np.uint32)


def round_steps(low: float, high: float, most: int) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten between two numbers, in at most ``most`` steps; none of no range."""
    rough = (high - low) / max(most, 1)
    if not 0.0 < rough < math.inf:
        return []
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * unit for unit in (1.0, 2.0, 5.0, 10.0) if power * unit >= rough * (1.0 - 1e-9))
    return [step * k for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def make_polyline(x: Reals, y: Reals) -> QPolygonF:
    """Line through points; the coordinates are copied at once, because an object for each point takes far longer."""
    line = QPolygonF()
    line.resize(x.size)
    if x.size:
        memory = wrap_memory(line.data(), POINT * x.size, True)
        np.frombuffer(memory, dtype=np.float64).reshape(x.size, 2)[:] = np.stack((x, y), axis=1)
    return line


def two_sided_palette() -> Bytes:
    """Palette of 256 differences: equal is the ground of the window, lower is blue, higher is copper."""
    low, none, high = (np.array([c.red(), c.green(), c.blue()], float) for c in map(QColor, (MARK, GROUND, ACCENT)))
    share = np.linspace(-1.0, 1.0, 256)[:, None]
    mixed = none + np.maximum(-share, 0.0) * (low - none) + np.maximum(share, 0.0) * (high - none)
    return np.rint(mixed).astype(np.uint8)


def image_of(pixels: Bytes) -> QImage:
    """Copy pixels into an image: (rows, columns) grey, or (rows, columns, 3 or 4) red, green, blue, opacity."""
    pixels = np.ascontiguousarray(pixels)
    rows, columns = pixels.shape[:2]
    depth = pixels[0, 0].size
    return QImage(pixels.data, columns, rows, columns * depth, FORMATS[depth]).copy()


def draw_veil(painter: QPainter, area: QRect) -> None:
    """Cover an area so far that words on it are read over any picture."""
    ground = QColor(GROUND)
    ground.setAlpha(215)
    painter.fillRect(area, ground)


def draw_pin(painter: QPainter, place: QPoint) -> None:
    """Draw a ring about the pinned pixel."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setBrush(Qt.BrushStyle.NoBrush)
    centre = QPointF(place)
    for colour, width in ((HALO, 5.0), (MARK_IN_WATER, 2.5)):
        painter.setPen(QPen(QColor(colour), width))
        painter.drawEllipse(centre, RING, RING)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)


def draw_lit(painter: QPainter, places: Iterable[QPoint]) -> None:
    """Draw the pixels that hear a place."""
    painter.setPen(QColor(HALO))
    painter.setBrush(QColor(LIT))
    for place in places:
        painter.drawRect(QRectF(place.x() - DOT, place.y() - DOT, 2.0 * DOT, 2.0 * DOT))
