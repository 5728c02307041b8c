"""Measures charts of the current scene and shows them in a window of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from insonify.scene import Scene, SceneError
from insonify_viewer.job import Job, Progress
from insonify_viewer.panels.chart.chart_details import ChartPicture, RowDetails, draw_chart, row_details
from insonify_viewer.panels.chart.view.chart_window import ChartWindow
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench

if TYPE_CHECKING:
    from insonify.accuracy.charts.kinds.accuracy import AccuracyChart
    from insonify.accuracy.charts.measurement import AccuracyRow

PATIENCE = 0.25  # s, for a measurement that is under way when the window closes


class ChartPanel(Panel):
    """Measures charts of the current scene, one at a time.

    The tow is paused during a measurement, because it would take time from what is timed.
    """

    name = "chart"
    title = "Chart"
    place = Place.WINDOW
    button = Button("Chart…", "Measure every method on the scene as it stands", "", menu="Tools")

    def __init__(self, workbench: Workbench) -> None:
        self._workbench = workbench
        self.measure: Any = None
        self.view: ChartWindow | None = None
        self._measurement: Job | None = None
        self._picture: ChartPicture | None = None

    @property
    def widget(self) -> ChartWindow:
        """The window, made when it is first asked for."""
        if self.view is None:
            self.view = ChartWindow()
            self.view.measure_wanted.connect(self.begin)
            self.view.stop_wanted.connect(self.stop)
            self.view.save_wanted.connect(self.save)
            self.view.picked.connect(self.pick)
        return self.view

    @property
    def busy(self) -> bool:
        """Whether a chart is being measured."""
        return self._measurement is not None

    def begin(self) -> None:
        """Measure the current scene."""
        if self.busy:
            return
        self._workbench.pause()
        scene, measure = self._workbench.session.scene, self.measure or _measured
        self._measurement = Job(
            lambda report: draw_chart(measure(scene, report)),
            self._workbench.simulator.call_later,
            progressed=self.widget.show_progress,
            done=self._take,
            failed=self._fail,
            name="chart",
        )
        self.widget.show_busy(True)
        self._measurement.start()

    def stop(self) -> None:
        """Stop the measurement."""
        if self._measurement is not None:
            self._measurement.stop()

    def pick(self, row: AccuracyRow) -> None:
        """Show the record behind a point of the chart."""
        if self._picture is not None:
            chart = self._picture.chart
            self._workbench.simulator.send(lambda: row_details(chart, row), self._show_details)

    def save(self) -> None:
        """Write the chart to a file that the person names."""
        if self._picture is None:
            return
        chart = self._picture.chart
        if path := self.widget.ask_where_to_save():
            self._workbench.simulator.send(lambda: _written(chart, path), self._tell)

    def closing(self) -> None:
        """Stop the measurement, wait a moment for its thread, and close the window."""
        if self._measurement is not None:
            self._measurement.close(PATIENCE)
            self._measurement = None
        if self.view is not None:
            self.view.close()

    def _take(self, picture: ChartPicture) -> None:
        if self.busy:  # else the window closed while the picture was on its way
            self._end()
            self._picture = picture
            self.widget.show_chart(picture)

    def _fail(self, sentence: str) -> None:
        if self.busy:
            self._end()
            self.widget.say(sentence or "stopped")

    def _end(self) -> None:
        if self._measurement is not None:
            self._measurement.close()
            self._measurement = None
        self.widget.show_busy(False)

    def _show_details(self, details: RowDetails | SceneError) -> None:
        if isinstance(details, SceneError):
            self.widget.say(str(details))
        else:
            self.widget.show_details(details)

    def _tell(self, written: str | SceneError) -> None:
        self.widget.say(str(written) if isinstance(written, SceneError) else f"written to {written}")


def _written(chart: AccuracyChart, path: str) -> str:
    chart.save(path)
    return path


def _measured(scene: Scene, progress: Progress) -> AccuracyChart:
    # lazy: the window opens before Numba and Matplotlib are loaded
    from insonify.accuracy.charts.kinds.accuracy import measure_chart

    return measure_chart(scene, progress=progress)
