"""Curves side by side, each with its axes, title and the figure that a reader looks for."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable

import numpy as np
from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen

from insonify.display.scene_curves import FLOOR, Curve
from insonify.scene import Scene, SceneError
from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.panels.parameters.setting_pictures.base import SettingPicture
from insonify_viewer.widgets.pixels import round_steps
from insonify_viewer.widgets.polylines import make_polyline
from insonify_viewer.widgets.theme import ACCENT, EDGE, QUIET, RAISED, TEXT

HEIGHT, GAP, LEFT = 104, 10.0, 8.0  # px: of the picture, between curves, before them
TITLE, SCALE = 30.0, 15.0  # px, of the two lines of words above a curve, and of the numbers below it
STEP = 10.0  # dB, between lines
Draw = Callable[[Scene], Curve | None]


class CurvesPicture(SettingPicture):
    """Curves of one setting."""

    _made = Signal(object, object)

    def __init__(self, applies: Callable[[Scene], bool], draws: tuple[Draw, ...]) -> None:
        super().__init__(HEIGHT)
        self._applies, self._draws = applies, draws
        self.curves: tuple[Curve, ...] = ()
        self._drawn: Scene | None = None  # whose curves these are
        self._making = False
        self._made.connect(self._take)

    def applies(self, scene: Scene) -> bool:
        """Whether a scene has these curves."""
        return self._applies(scene)

    @guard_override(None)
    def paintEvent(self, event: QPaintEvent) -> None:
        """Paint the curves side by side; others that are due follow a moment later."""
        del event
        self._begin()
        curves = self.curves
        if not curves:
            return
        with QPainter(self) as painter:
            wide = (self.width() - LEFT - GAP * (len(curves) - 1)) / len(curves)
            for place, curve in enumerate(curves):
                _paint(painter, curve, QRectF(LEFT + place * (wide + GAP), 0.0, wide, self.height()))

    def _begin(self) -> None:
        """Make the curves of the present scene, on a thread of their own: those of a long pulse take a while."""
        if self._scene is not None and self._scene is not self._drawn and not self._making:
            self._making = True
            threading.Thread(target=self._make, args=(self._scene,), name="insonify curves", daemon=True).start()

    def _make(self, scene: Scene) -> None:
        try:
            made = tuple(curve for curve in (draw(scene) for draw in self._draws) if curve is not None)
        except SceneError:
            made = ()
        with contextlib.suppress(RuntimeError):  # the picture has been deleted
            self._made.emit(scene, made)

    def _take(self, scene: Scene, curves: tuple[Curve, ...]) -> None:
        """Show curves that are made; if the scene has changed meanwhile, the next follow."""
        self.curves, self._drawn, self._making = curves, scene, False
        self.setToolTip("\n".join(f"{curve.title}: {curve.note}{_scale(curve)}" for curve in curves))
        self.update()


def _paint(painter: QPainter, curve: Curve, area: QRectF) -> None:
    """Paint one curve with its words above and its scale below."""
    plot = area.adjusted(0.0, TITLE, 0.0, -SCALE)
    _words(painter, TEXT, QRectF(area.left(), area.top(), area.width(), 0.5 * TITLE), curve.title)
    _words(painter, QUIET, QRectF(area.left(), area.top() + 0.5 * TITLE, area.width(), 0.5 * TITLE), curve.note)
    painter.fillRect(plot, QColor(RAISED))
    low, high = (FLOOR, 0.0) if curve.y_unit == "dB" else (0.0, 1.05)
    first, last = float(curve.x[0]), float(curve.x[-1])
    _paint_scales(painter, curve, plot, (first, last))
    columns = np.linspace(0, curve.x.size - 1, max(int(2.0 * plot.width()), 2)).astype(np.int64)
    x = plot.left() + (curve.x[columns] - first) / (last - first) * plot.width()
    y = plot.bottom() - (np.clip(curve.y[columns], low, high) - low) / (high - low) * (plot.height() - 2.0)
    painter.setPen(QPen(QColor(ACCENT), 1.3))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.drawPolyline(make_polyline(x, y))
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)


def _paint_scales(painter: QPainter, curve: Curve, plot: QRectF, ends: tuple[float, float]) -> None:
    """Paint lines every few decibels, and numbers below."""
    painter.setPen(QColor(EDGE))
    if curve.y_unit == "dB":
        for level in np.arange(FLOOR + STEP, 0.0, STEP):
            y = round(plot.bottom() - (level - FLOOR) / -FLOOR * plot.height())
            painter.drawLine(round(plot.left()), y, round(plot.right()), y)
    for value in round_steps(*ends, max(int(plot.width() / 55.0), 2)):
        x = plot.left() + (value - ends[0]) / (ends[1] - ends[0]) * plot.width()
        painter.setPen(QColor(EDGE))
        painter.drawLine(round(x), round(plot.top()), round(x), round(plot.bottom()))
        if plot.left() + 16.0 <= x <= plot.right() - 20.0:
            painter.setPen(QColor(QUIET))
            box = QRectF(x - 40.0, plot.bottom(), 80.0, SCALE)
            unit = curve.x_unit if curve.x_unit == "°" else f" {curve.x_unit}"
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, f"{value:g}{unit}".replace("-", "−"))


def _scale(curve: Curve) -> str:
    """Say what the lines across a curve of levels are."""
    return f" ({STEP:g} dB from line to line)" if curve.y_unit == "dB" else ""


def _words(painter: QPainter, colour: QColor, area: QRectF, words: str) -> None:
    painter.setPen(QColor(colour))
    shown = painter.fontMetrics().elidedText(words, Qt.TextElideMode.ElideRight, int(area.width()))
    painter.drawText(area, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter, shown)
