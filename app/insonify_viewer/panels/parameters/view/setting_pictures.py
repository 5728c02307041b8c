"""Pictures of settings below their rows: beam, pulse, backscatter, and the spectrum of the relief."""

import contextlib
import threading
from collections.abc import Callable

import numpy as np
from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

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
from insonify_viewer.widgets.buttons import make_label
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.plot import Canvas, Plot
from insonify_viewer.widgets.text import ElidedLabel
from insonify_viewer.widgets.theme import ACCENT, MARK, scaled

CURVE_HEIGHT, SPECTRUM_HEIGHT = 118, 176  # px at the usual size of the text
STEP = 10.0  # dB, between lines
Draw = Callable[[Scene], Curve | None]
LISTED = 5  # peaks that are listed beside a spectrum
PATH = "seabed.relief.peaks"


class SettingPicture(QWidget):
    """A picture of a part of the scene, hidden while the scene has nothing to draw there."""

    dragged = Signal(str, object)  # dotted path and value while a point of the picture is dragged
    settled = Signal(str, object)  # the same when it is released

    def __init__(self, height: int) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFixedHeight(scaled(self, height))
        self._scene: Scene | None = None

    def show_scene(self, scene: Scene) -> None:
        """Show another scene; what is folded away or scrolled out of sight costs nothing."""
        self._scene = scene
        self.setVisible(self.applies(scene))
        for plot in self.findChildren(Plot):
            plot.redraw()

    def applies(self, scene: Scene) -> bool:
        """Whether a scene has something to draw here."""
        raise NotImplementedError


class CurvesPicture(SettingPicture):
    """Curves of one setting, side by side."""

    _made = Signal(object, object, object)

    def __init__(self, applies: Callable[[Scene], bool], draws: tuple[Draw, ...]) -> None:
        super().__init__(CURVE_HEIGHT)
        self._applies, self.draws = applies, draws
        self.curves: tuple[Curve, ...] = ()
        self._drawn: Scene | None = None  # the scene of these curves
        self._making, self._faults = False, FaultReport()
        self._made.connect(self._take)
        self._parts = [CurvePart(self.begin) for _ in draws]
        fill(QHBoxLayout(self), *self._parts, margins=(0, 0, 0, 0), spacing=6)

    def applies(self, scene: Scene) -> bool:
        """Whether a scene has these curves."""
        return self._applies(scene)

    def begin(self) -> None:
        """Make the curves of the present scene, on a thread of their own: those of a long pulse take a while."""
        if self._scene is not None and self._scene is not self._drawn and not self._making:
            self._making = True
            threading.Thread(target=self._make, args=(self._scene,), name="insonify curves", daemon=True).start()

    def _make(self, scene: Scene) -> None:
        made: tuple[Curve, ...] = ()
        error: Exception | None = None
        try:
            made = tuple(curve for curve in (draw(scene) for draw in self.draws) if curve is not None)
        except Exception as raised:  # an exception that ends the thread would freeze the picture silently
            error = raised
        with contextlib.suppress(RuntimeError):  # the picture has been deleted
            self._made.emit(scene, made, error)

    def _take(self, scene: Scene, curves: tuple[Curve, ...], error: Exception | None) -> None:
        """Show curves that are made, or report why not; if the scene has changed meanwhile, the next follow."""
        self.curves, self._drawn, self._making = curves, scene, False
        self.setToolTip("\n".join(f"{curve.title}: {curve.note}" for curve in curves))
        for number, part in enumerate(self._parts):
            part.show_curve(curves[number] if number < len(curves) else None)
            part.setVisible(number < max(len(curves), 1))
        self._faults.report(error)


class CurvePart(QWidget):
    """One curve below its words."""

    def __init__(self, begin: Callable[[], None]) -> None:
        super().__init__()
        self._title, self._note, self._plot = ElidedLabel("figure"), ElidedLabel("name"), CurvePlot(begin)
        parts = self._title, self._note, self._plot
        fill(QVBoxLayout(self), *parts, growing=self._plot, margins=(0, 0, 0, 0), spacing=0)

    def show_curve(self, curve: Curve | None) -> None:
        """Show a curve; None takes it away."""
        self._title.say("" if curve is None else curve.title)
        self._note.say("" if curve is None else curve.note)
        self._plot.curve = curve
        self._plot.redraw()


class CurvePlot(Plot):
    """Plot of one curve."""

    def __init__(self, begin: Callable[[], None]) -> None:
        super().__init__("Curve of the setting", still=True)
        self.curve: Curve | None = None
        self._begin = begin

    def draw(self, canvas: Canvas) -> None:
        """Draw the curve; another that is due follows a moment later."""
        self._begin()
        if (curve := self.curve) is None:
            return
        canvas.getAxis("left").setTickSpacing(*((2.0 * STEP, STEP) if curve.y_unit == "dB" else (0.5, 0.25)))
        canvas.unit("bottom", curve.x_unit)
        canvas.unit("left", curve.y_unit)
        if curve.beside is not None:
            canvas.line(curve.x, curve.beside, MARK, 1.0, style=Qt.PenStyle.DashLine)
        canvas.line(curve.x, curve.y, ACCENT, 1.3)
        low, high = (FLOOR, 0.0) if curve.y_unit == "dB" else (0.0, 1.05)
        self.limit((float(curve.x[0]), float(curve.x[-1])), (low, high + 0.04 * (high - low)))


class SpectrumPicture(SettingPicture):
    """The plane of wave numbers with the declared peaks, and words beside it."""

    def __init__(self) -> None:
        super().__init__(SPECTRUM_HEIGHT)
        self.plot = SpectrumPlot(self)
        self.words = make_label("figure")
        self.words.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.words.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        row = fill(QHBoxLayout(self), margins=(0, 0, 0, 0))
        row.addWidget(self.plot, 3)
        row.addWidget(self.words, 2)

    @property
    def scene(self) -> Scene | None:
        """The scene that is shown."""
        return self._scene

    def applies(self, scene: Scene) -> bool:
        """Whether the bed is fractal."""
        return isinstance(scene.seabed.relief, Fractal)

    def describe(self, spectrum: ReliefSpectrum) -> None:
        """State beside the plane what it spans and what the peaks are."""
        relief = self._scene.seabed.relief if self._scene is not None else None
        period = relief.period if isinstance(relief, Fractal) else 0.0
        lines = [f"edge: {spectrum.reach:.3g} waves in a period", f"black: −{-FLOOR:g} dB", ""]
        for fx, fy in spectrum.peaks[:LISTED]:
            away = float(np.hypot(fx, fy))
            lines.append(f"{fx:g}, {fy:g}" + (f": {period / away:.3g} m" if away > 0.0 else ": long waves"))
        self.words.setText("\n".join(lines).replace("-", "−"))


class SpectrumPlot(Plot):
    """Spectrum of the relief; its peaks can be dragged."""

    def __init__(self, picture: SpectrumPicture) -> None:
        tip = "Drag a peak to shape the bed: its direction is that of the waves, farther out they are shorter"
        super().__init__("Spectrum of the relief", tip, still=True, grid=False)
        self._picture = picture
        self._reach = 0.0  # cycles a period, while a peak is dragged
        self.dragged.connect(self._drag)
        self.released.connect(lambda: picture.settled.emit(PATH, [list(peak) for peak in self.marks]))

    def draw(self, canvas: Canvas) -> None:
        """Draw the plane; its reach stays while a peak is dragged."""
        scene = self._picture.scene
        spectrum = None if scene is None else relief_spectrum(scene, self._reach if self.moving else None)
        if spectrum is None:
            return
        self.marks, self._reach = spectrum.peaks, spectrum.reach
        ends = -self._reach, self._reach
        canvas.setAspectLocked(True)
        canvas.picture(spectrum.decibels, ends, ends, levels=(FLOOR, 0.0))
        self.limit(ends, ends)
        self._picture.describe(spectrum)

    def _drag(self, number: int, x: float, y: float) -> None:
        """Move a peak, in whole cycles a period."""
        moved = [float(round(min(max(wave, -self._reach), self._reach))) for wave in (x, y)]
        self.marks = [(moved[0], moved[1]) if k == number else peak for k, peak in enumerate(self.marks)]
        self._picture.dragged.emit(PATH, [list(peak) for peak in self.marks])


def pictures_of_settings() -> dict[str, SettingPicture]:
    """Make the pictures, by the dotted path of the setting that they belong to."""
    return {
        "sonar.beam": CurvesPicture(lambda scene: scene.sonar.beam.has_width, (beam_curve,)),
        "sonar.vertical": CurvesPicture(lambda scene: scene.sonar.vertical.shades, (vertical_beam_curve,)),
        "sonar.pulse": CurvesPicture(lambda scene: scene.sonar.pulse.length > 0.0, (pulse_curve, pulse_spectrum_curve)),
        "seabed.material": CurvesPicture(has_backscatter_model, (backscatter_curve,)),
        "seabed.relief.peaks": SpectrumPicture(),
    }
