"""Spectrum of a fractal bed, whose peaks are dragged."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen

from insonify.display.scene_curves import FLOOR, ReliefSpectrum, relief_spectrum
from insonify.scene import Scene
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.panels.parameters.setting_pictures.base import SettingPicture
from insonify_viewer.widgets.theme import ACCENT, GROUND, MARK, QUIET, TEXT

HEIGHT, WORDS, LEFT = 176, 17.0, 8.0  # px: of the picture, of the line above it, before it
HANDLE, NEAR = 4.5, 12.0  # px: radius of a peak, and distance from which it is taken
PATH = "seabed.relief.peaks"


class SpectrumPicture(SettingPicture):
    """The plane of wave numbers with the declared peaks."""

    def __init__(self) -> None:
        super().__init__(HEIGHT)
        self.setMouseTracking(True)
        self.setToolTip("Drag a peak: far from the middle for short waves, towards the side that the waves run")
        self._drawn: tuple[Scene, ReliefSpectrum, QImage] | None = None
        self._held: int | None = None
        self._reach = 0.0  # cycles a period, while a peak is held

    @property
    def spectrum(self) -> ReliefSpectrum | None:
        """The spectrum of the present scene."""
        scene = self._scene
        if scene is None:
            return None
        if self._drawn is None or self._drawn[0] is not scene:
            made = relief_spectrum(scene, self._reach if self._held is not None else None)
            if made is None:
                return None
            self._drawn = scene, made, _image(made)
        return self._drawn[1]

    @property
    def area(self) -> QRectF:
        """Square that the plane fills, in px."""
        side = min(self.height() - WORDS, self.width() - 2.0 * LEFT)
        return QRectF(LEFT, WORDS, side, side)

    def applies(self, scene: Scene) -> bool:
        """Whether the bed is fractal."""
        return isinstance(scene.seabed.relief, Fractal)

    def place_of(self, peak: tuple[float, float]) -> QPointF:
        """Place of a peak in px."""
        assert self.spectrum is not None
        area, reach = self.area, self.spectrum.reach
        across, up = (0.5 + 0.5 * wave / reach for wave in peak)
        return QPointF(area.left() + across * area.width(), area.bottom() - up * area.height())

    @guard_override(None)
    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the plane, its axes and the peaks."""
        del event
        spectrum = self.spectrum
        if spectrum is None or self._drawn is None:
            return
        with QPainter(self) as painter:
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
            area = self.area
            painter.drawImage(area, self._drawn[2])
            painter.setPen(QColor(TEXT))
            painter.drawText(
                QRectF(LEFT, 0.0, self.width() - LEFT, WORDS - 3.0), Qt.AlignmentFlag.AlignLeft, "Spectrum"
            )
            self._paint_words(painter, spectrum)
            for number, peak in enumerate(spectrum.peaks):
                painter.setPen(QPen(QColor(GROUND), 1.0))
                painter.setBrush(QColor(ACCENT if number == self._held else MARK))
                painter.drawEllipse(self.place_of(peak), HANDLE, HANDLE)

    def _paint_words(self, painter: QPainter, spectrum: ReliefSpectrum) -> None:
        """Say beside the plane what it spans and what the peaks are."""
        left = self.area.right() + 8.0
        relief = self._scene.seabed.relief if self._scene is not None else None
        period = relief.period if isinstance(relief, Fractal) else 0.0
        lines = [f"±{spectrum.reach:.3g} cycles a period", f"shades of {-FLOOR:g} dB", ""]
        for fx, fy in spectrum.peaks[:5]:
            away = float(np.hypot(fx, fy))
            lines.append(f"{fx:g}, {fy:g}" + (f": {period / away:.3g} m" if away > 0.0 else ": long waves"))
        painter.setPen(QColor(QUIET))
        tall = painter.fontMetrics().lineSpacing()
        for line, words in enumerate(lines):
            box = QRectF(left, WORDS + line * tall, self.width() - left, tall)
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, words)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the peak under the mouse."""
        self._held = self._peak_near(event.position())
        if self._held is not None and self.spectrum is not None:
            self._reach = self.spectrum.reach
            self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the peak that is held; otherwise show whether there is one to take."""
        if self._held is None:
            near = self._peak_near(event.position()) is not None
            self.setCursor(Qt.CursorShape.OpenHandCursor if near else Qt.CursorShape.ArrowCursor)
            return
        self.dragged.emit(PATH, self._moved(event.position()))

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let the peak go."""
        if self._held is None:
            return
        peaks = self._moved(event.position())
        self._held, self._drawn = None, None
        self.settled.emit(PATH, peaks)
        self.update()

    def _peak_near(self, position: QPointF) -> int | None:
        """Return the number of the nearest peak within reach of the mouse."""
        if self.spectrum is None:
            return None
        away = [(self.place_of(peak) - position).manhattanLength() for peak in self.spectrum.peaks]
        nearest = int(np.argmin(away))
        return nearest if away[nearest] <= NEAR else None

    def _moved(self, position: QPointF) -> list[list[float]]:
        """Return all peaks, that which is held at the mouse, in whole cycles a period."""
        assert self.spectrum is not None
        assert self._held is not None
        area, reach = self.area, self._reach
        across = (position.x() - area.left()) / area.width()
        up = (area.bottom() - position.y()) / area.height()
        peaks = [list(peak) for peak in self.spectrum.peaks]
        peaks[self._held] = [float(round((2.0 * min(max(share, 0.0), 1.0) - 1.0) * reach)) for share in (across, up)]
        return peaks


def _image(spectrum: ReliefSpectrum) -> QImage:
    """Make the grey picture of a spectrum, fy upwards."""
    grey = np.ascontiguousarray((255.0 * (1.0 - spectrum.decibels[::-1] / FLOOR)).astype(np.uint8))
    rows, columns = grey.shape
    return QImage(grey.data, columns, rows, columns, QImage.Format.Format_Grayscale8).copy()
