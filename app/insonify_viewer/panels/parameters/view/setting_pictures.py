"""Pictures of settings below their rows: beam, pulse, backscatter, and the spectrum of the relief."""

import contextlib
import threading
from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QSizePolicy

from insonify.display.scene_curves import (
    FLOOR,
    Curve,
    ReliefSpectrum,
    backscatter_curve,
    beam_curve,
    has_backscatter_model,
    pulse_curve,
    pulse_spectrum_curve,
    relief_spectrum,
    vertical_beam_curve,
)
from insonify.scene import Scene
from insonify.scene.seabed.reliefs.fractal import Fractal
from insonify_viewer.errors import FaultReport
from insonify_viewer.state.quantities import nearest_within
from insonify_viewer.widgets.painting import Painted, image_of, make_polyline, round_steps
from insonify_viewer.widgets.theme import ACCENT, EDGE, GROUND, MARK, QUIET, RAISED, TEXT, scaled

LEFT = 8.0  # px, before curves and spectrum
CURVE_HEIGHT, GAP = 104, 10.0  # px: of the picture, between curves
STEP = 10.0  # dB, between lines
Draw = Callable[[Scene], Curve | None]
SPECTRUM_HEIGHT = 176  # px at the usual size of the text, as `CURVE_HEIGHT`
HANDLE, NEAR = 4.5, 12.0  # px: radius of a peak, and distance from which it is taken
PATH = "seabed.relief.peaks"


class SettingPicture(Painted):
    """A picture of a part of the scene, hidden while the scene has nothing to draw there."""

    # It is computed when it is next painted: one that is folded away or scrolled out of sight costs nothing.

    dragged = Signal(str, object)  # dotted path and value while a point of the picture is dragged
    settled = Signal(str, object)  # the same when it is released

    def __init__(self, height: int) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFixedHeight(scaled(self, height))
        self._scene: Scene | None = None

    def show_scene(self, scene: Scene) -> None:
        """Show another scene."""
        self._scene = scene
        self.setVisible(self.applies(scene))
        self.update()

    def applies(self, scene: Scene) -> bool:
        """Whether a scene has something to draw here."""
        raise NotImplementedError


class CurvesPicture(SettingPicture):
    """Curves of one setting."""

    _made = Signal(object, object, object)

    def __init__(self, applies: Callable[[Scene], bool], draws: tuple[Draw, ...]) -> None:
        super().__init__(CURVE_HEIGHT)
        self._applies, self._draws = applies, draws
        self.curves: tuple[Curve, ...] = ()
        self._drawn: Scene | None = None  # the scene of these curves
        self._making, self._faults = False, FaultReport()
        self._made.connect(self._take)

    def applies(self, scene: Scene) -> bool:
        """Whether a scene has these curves."""
        return self._applies(scene)

    def paint(self, painter: QPainter) -> None:
        """Paint the curves side by side; others that are due follow a moment later."""
        self._begin()
        curves = self.curves
        wide = (self.width() - LEFT - GAP * (len(curves) - 1)) / max(len(curves), 1)
        for place, curve in enumerate(curves):
            _paint(painter, curve, QRectF(LEFT + place * (wide + GAP), 0.0, wide, self.height()))

    def _begin(self) -> None:
        """Make the curves of the present scene, on a thread of their own: those of a long pulse take a while."""
        if self._scene is not None and self._scene is not self._drawn and not self._making:
            self._making = True
            threading.Thread(target=self._make, args=(self._scene,), name="insonify curves", daemon=True).start()

    def _make(self, scene: Scene) -> None:
        made: tuple[Curve, ...] = ()
        error: Exception | None = None
        try:
            made = tuple(curve for curve in (draw(scene) for draw in self._draws) if curve is not None)
        except Exception as raised:  # an exception that ends the thread would freeze the picture silently
            error = raised
        with contextlib.suppress(RuntimeError):  # the picture has been deleted
            self._made.emit(scene, made, error)

    def _take(self, scene: Scene, curves: tuple[Curve, ...], error: Exception | None) -> None:
        """Show curves that are made, or report why not; if the scene has changed meanwhile, the next follow."""
        self.curves, self._drawn, self._making = curves, scene, False
        self.setToolTip("\n".join(f"{curve.title}: {curve.note}{_scale(curve)}" for curve in curves))
        self.update()
        self._faults.report(error)


def _paint(painter: QPainter, curve: Curve, area: QRectF) -> None:
    """Paint one curve with its words above and its scale below."""
    line = float(painter.fontMetrics().height())
    plot = area.adjusted(0.0, 2.0 * line, 0.0, -line)
    _words(painter, TEXT, QRectF(area.left(), area.top(), area.width(), line), curve.title)
    _words(painter, QUIET, QRectF(area.left(), area.top() + line, area.width(), line), curve.note)
    painter.fillRect(plot, QColor(RAISED))
    low, high = (FLOOR, 0.0) if curve.y_unit == "dB" else (0.0, 1.05)
    first, last = float(curve.x[0]), float(curve.x[-1])
    _paint_scales(painter, curve, plot, (first, last))
    columns = np.linspace(0, curve.x.size - 1, max(int(2.0 * plot.width()), 2)).astype(np.int64)
    x = plot.left() + (curve.x[columns] - first) / (last - first) * plot.width()
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for values, pen in (
        (curve.beside, QPen(QColor(MARK), 1.0, Qt.PenStyle.DashLine)),
        (curve.y, QPen(QColor(ACCENT), 1.3)),
    ):
        if values is not None:
            y = plot.bottom() - (np.clip(values[columns], low, high) - low) / (high - low) * (plot.height() - 2.0)
            painter.setPen(pen)
            painter.drawPolyline(make_polyline(x, y))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)


def _paint_scales(painter: QPainter, curve: Curve, plot: QRectF, ends: tuple[float, float]) -> None:
    """Paint lines every few decibels, and numbers below."""
    painter.setPen(QColor(EDGE))
    if curve.y_unit == "dB":
        for level in np.arange(FLOOR + STEP, 0.0, STEP):
            y = round(plot.bottom() - (level - FLOOR) / -FLOOR * plot.height())
            painter.drawLine(round(plot.left()), y, round(plot.right()), y)
    for value in round_steps(*ends, max(int(plot.width() / (3.7 * painter.fontMetrics().height())), 2)):
        x = plot.left() + (value - ends[0]) / (ends[1] - ends[0]) * plot.width()
        painter.setPen(QColor(EDGE))
        painter.drawLine(round(x), round(plot.top()), round(x), round(plot.bottom()))
        if plot.left() + 16.0 <= x <= plot.right() - 20.0:
            painter.setPen(QColor(QUIET))
            box = QRectF(x - 40.0, plot.bottom(), 80.0, painter.fontMetrics().height())
            unit = curve.x_unit if curve.x_unit == "°" else f" {curve.x_unit}"
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, f"{value:g}{unit}".replace("-", "−"))


def _scale(curve: Curve) -> str:
    """State what the lines across a curve of levels are."""
    return f" ({STEP:g} dB from line to line)" if curve.y_unit == "dB" else ""


def _words(painter: QPainter, colour: QColor, area: QRectF, words: str) -> None:
    painter.setPen(QColor(colour))
    shown = painter.fontMetrics().elidedText(words, Qt.TextElideMode.ElideRight, int(area.width()))
    painter.drawText(area, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, shown)


class SpectrumPicture(SettingPicture):
    """The plane of wave numbers with the declared peaks."""

    def __init__(self) -> None:
        super().__init__(SPECTRUM_HEIGHT)
        self.setMouseTracking(True)
        self.setToolTip(
            "Drag a peak to shape the bed: its direction is that of the waves, farther out they are shorter"
        )
        self._drawn: tuple[Scene, ReliefSpectrum, QImage] | None = None
        self._held: int | None = None
        self._reach = 0.0  # cycles a period, while a peak is dragged

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
        words = self.fontMetrics().height() + 3.0  # above the plane
        side = min(self.height() - words, self.width() - 2.0 * LEFT)
        return QRectF(LEFT, words, side, side)

    def applies(self, scene: Scene) -> bool:
        """Whether the bed is fractal."""
        return isinstance(scene.seabed.relief, Fractal)

    def place_of(self, peak: tuple[float, float]) -> QPointF:
        """Place of a peak in px."""
        assert self.spectrum is not None
        area, reach = self.area, self.spectrum.reach
        across, up = (0.5 + 0.5 * wave / reach for wave in peak)
        return QPointF(area.left() + across * area.width(), area.bottom() - up * area.height())

    def paint(self, painter: QPainter) -> None:
        """Paint the plane, its axes and the peaks."""
        spectrum = self.spectrum
        if spectrum is None or self._drawn is None:
            return
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        area = self.area
        painter.drawImage(area, self._drawn[2])
        painter.setPen(QColor(TEXT))
        heading = QRectF(LEFT, 0.0, self.width() - LEFT, area.top())
        painter.drawText(heading, Qt.AlignmentFlag.AlignLeft, "Spectrum")
        self._paint_words(painter, spectrum)
        for number, peak in enumerate(spectrum.peaks):
            painter.setPen(QPen(QColor(GROUND), 1.0))
            painter.setBrush(QColor(ACCENT if number == self._held else MARK))
            painter.drawEllipse(self.place_of(peak), HANDLE, HANDLE)

    def _paint_words(self, painter: QPainter, spectrum: ReliefSpectrum) -> None:
        """State beside the plane what it spans and what the peaks are."""
        left = self.area.right() + 8.0
        relief = self._scene.seabed.relief if self._scene is not None else None
        period = relief.period if isinstance(relief, Fractal) else 0.0
        lines = [f"edge: {spectrum.reach:.3g} waves", "in a period", f"black: −{-FLOOR:g} dB", ""]
        for fx, fy in spectrum.peaks[:5]:
            away = float(np.hypot(fx, fy))
            lines.append(f"{fx:g}, {fy:g}" + (f": {period / away:.3g} m" if away > 0.0 else ": long waves"))
        painter.setPen(QColor(QUIET))
        tall = painter.fontMetrics().lineSpacing()
        for line, words in enumerate(lines):
            box = QRectF(left, self.area.top() + line * tall, self.width() - left, tall)
            painter.drawText(box, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, words)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take the peak under the mouse."""
        self._held = self._peak_near(event.position())
        if self._held is not None and self.spectrum is not None:
            self._reach = self.spectrum.reach
            self.update()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the grasped peak; otherwise show whether there is one to take."""
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
        return nearest_within(away, NEAR)

    def _moved(self, position: QPointF) -> list[list[float]]:
        """Return all peaks, with the dragged one at the mouse, in whole cycles a period."""
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
    return image_of((255.0 * (1.0 - spectrum.decibels[::-1] / FLOOR)).astype(np.uint8))


def pictures_of_settings() -> dict[str, SettingPicture]:
    """Make the pictures, by the dotted path of the setting that they belong to."""
    return {
        "sonar.beam": CurvesPicture(lambda scene: scene.sonar.beam.has_width, (beam_curve,)),
        "sonar.vertical": CurvesPicture(lambda scene: scene.sonar.vertical.shades, (vertical_beam_curve,)),
        "sonar.pulse": CurvesPicture(lambda scene: scene.sonar.pulse.length > 0.0, (pulse_curve, pulse_spectrum_curve)),
        "seabed.material": CurvesPicture(has_backscatter_model, (backscatter_curve,)),
        "seabed.relief.peaks": SpectrumPicture(),
    }
