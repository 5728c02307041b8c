"""Opens the window of the chart, and does what is asked for there."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from PySide6.QtWidgets import QFileDialog

from insonify.scene import SceneError
from insonify_viewer.panels.chart.chart_details import Judged, Pictured, judge
from insonify_viewer.panels.chart.measurement import Measurement
from insonify_viewer.panels.chart.view.chart_window import ChartWindow
from insonify_viewer.session import Session

if TYPE_CHECKING:
    from insonify.accuracy.charts.kinds.accuracy import AccuracyChart
    from insonify.accuracy.charts.measurement import AccuracyRow
    from insonify_viewer.simulator import Simulator
    from insonify_viewer.views.main_window import MainWindow

KINDS = "Picture (*.png);;Drawing (*.svg);;Table (*.csv);;Table (*.json)"


class ChartPanel:
    """Measures charts of the current scene, one at a time.

    Parameters
    ----------
    session : Session
        Whose scene is measured.
    window : MainWindow
        Who is asked for the chart.
    simulator : Simulator
        Whose worker compares records and writes files.
    pause : callable
        Pauses the tow, which would take time from what is being timed.
    """

    def __init__(self, session: Session, window: MainWindow, simulator: Simulator, pause: Callable[[], None]) -> None:
        self._session, self._window, self._simulator, self._pause = session, window, simulator, pause
        self.measure: Any = None
        self.view: ChartWindow | None = None
        self._measurement: Measurement | None = None
        self._pictured: Pictured | None = None
        window.plan.chart_wanted.connect(self.show)

    @property
    def busy(self) -> bool:
        """Whether a chart is being measured."""
        return self._measurement is not None

    def show(self) -> None:
        """Open the window, or bring it to the front."""
        if self.view is None:
            self.view = ChartWindow(self._window)
            self.view.measure_wanted.connect(self.begin)
            self.view.stop_wanted.connect(self.stop)
            self.view.save_wanted.connect(self.save)
            self.view.picked.connect(self.pick)
        self.view.show()
        self.view.raise_()

    def begin(self) -> None:
        """Measure the current scene."""
        if self.busy or self.view is None:
            return
        self._pause()
        measurement = self._measurement = Measurement(self._session.scene, self.measure, self._window)
        measurement.progressed.connect(self.view.show_progress)
        measurement.drawn.connect(self._take)
        measurement.failed.connect(self._fail)
        self.view.show_busy(True)
        measurement.start()

    def stop(self) -> None:
        """Give the measurement up."""
        if self._measurement is not None:
            self._measurement.stop()

    def pick(self, row: AccuracyRow) -> None:
        """Show the record behind a point of the chart."""
        if self._pictured is not None:
            chart = self._pictured.chart
            self._simulator.send(lambda: judge(chart, row), self._show_judged)

    def save(self) -> None:
        """Write the chart to a file that the person names."""
        if self._pictured is None or self.view is None:
            return
        chart = self._pictured.chart
        path, _ = QFileDialog.getSaveFileName(self.view, "Save the chart", "chart.png", KINDS)
        if path:
            self._simulator.send(lambda: _written(chart, path), self._tell)

    def close(self) -> None:
        """Give everything up, and wait for it."""
        if self._measurement is not None:
            self._measurement.close()
            self._measurement = None
        if self.view is not None:
            self.view.close()

    def _take(self, pictured: Pictured) -> None:
        if not self.busy:  # it was on its way when the window closed
            return
        self._end()
        self._pictured = pictured
        assert self.view is not None
        self.view.show_chart(pictured)

    def _fail(self, sentence: str) -> None:
        if not self.busy:
            return
        self._end()
        assert self.view is not None
        self.view.say(sentence or "stopped")

    def _end(self) -> None:
        if self._measurement is not None:
            self._measurement.close()
            self._measurement.deleteLater()
            self._measurement = None
        if self.view is not None:
            self.view.show_busy(False)

    def _show_judged(self, judged: Judged | SceneError) -> None:
        if self.view is None:
            return
        if isinstance(judged, SceneError):
            self.view.say(str(judged))
        else:
            self.view.show_judged(judged)

    def _tell(self, written: str | SceneError) -> None:
        if self.view is not None:
            self.view.say(str(written) if isinstance(written, SceneError) else f"written to {written}")


def _written(chart: AccuracyChart, path: str) -> str:
    chart.save(path)
    return path
