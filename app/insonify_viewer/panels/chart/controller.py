"""Measures charts of the current scene and shows them in a window of their own."""

from functools import partial
from typing import Any

from insonify.scene import Scene, SceneError
from insonify_viewer.core_types import AccuracyChart, AccuracyRow
from insonify_viewer.panels.chart.chart_details import RowDetails, row_details
from insonify_viewer.panels.chart.view import ChartWindow
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.work.executor import Progress
from insonify_viewer.work.jobs import BackgroundJob, State, ThreadJob


class ChartPanel(Panel):
    """Measures charts of the current scene, one at a time."""

    # The tow is paused during a measurement, because it would take time from what is timed.

    name = "chart"
    title = "Chart"
    place = Place.WINDOW
    button = Button("Chart…", "Measure speed and error of every method on this scene", "", menu="Tools")

    def __init__(self, workbench: Workbench) -> None:
        self._workbench = workbench
        self.measure: Any = None
        self.view: ChartWindow | None = None
        self._measurement: ThreadJob | None = None
        workbench.jobs.changed.connect(self._follow)
        self._chart: AccuracyChart | None = None

    @property
    def widget(self) -> ChartWindow:
        """The window, made on first use."""
        if self.view is None:
            self.view = ChartWindow()
            self.view.measure.clicked.connect(self.begin)
            self.view.stop.clicked.connect(self.stop)
            self.view.save.clicked.connect(self.save)
            self.view.picked.connect(self.pick)
        return self.view

    @property
    def busy(self) -> bool:
        """Whether a chart is being measured."""
        return self._measurement is not None and self._measurement.running

    def begin(self) -> None:
        """Measure the current scene."""
        if self.busy:
            return
        self._workbench.pause()
        scene, measure = self._workbench.session.scene, self.measure or _measured
        self.widget.show_busy(True)
        title = f"chart of {scene.title or 'the scene'}"
        self._measurement = self._workbench.jobs.begin_work(title, lambda report: measure(scene, report))

    def stop(self) -> None:
        """Stop the measurement."""
        if self._measurement is not None:
            self._measurement.stop()

    def pick(self, row: AccuracyRow) -> None:
        """Show the record behind a point of the chart."""
        chart = self._chart
        if chart is not None:
            self._workbench.simulator.send(lambda: row_details(chart, row), self._show_details)

    def save(self) -> None:
        """Write the chart to a file that the person names."""
        chart = self._chart
        if chart is not None and (path := self.widget.ask_where_to_save()):
            self._workbench.simulator.send(lambda: chart.save(path), partial(self._tell, path))

    def _follow(self, job: BackgroundJob) -> None:
        """Show how far the measurement is, and what came of it."""
        if job is not self._measurement or not isinstance(job, ThreadJob):
            return
        if job.running:
            self.widget.show_progress(job.stage.share or 0.0, job.seconds_left)
            return
        self.widget.show_busy(False)
        if job.state is State.DONE:
            self._chart = job.value
            self.widget.show_chart(job.value)
        else:
            self.widget.say("stopped" if job.state is State.STOPPED else job.sentence)

    def _show_details(self, details: RowDetails | SceneError) -> None:
        if isinstance(details, SceneError):
            self._workbench.complain(details)
            self.widget.say(str(details))
        else:
            self.widget.show_details(details)

    def _tell(self, path: str, error: SceneError | None) -> None:
        if error is not None:
            self._workbench.complain(error)
        self.widget.say(f"saved {path}" if error is None else str(error))


def _measured(scene: Scene, progress: Progress) -> AccuracyChart:
    # lazy: the window opens before Numba and Matplotlib are loaded
    from insonify.accuracy.charts.kinds.accuracy import measure_chart

    return measure_chart(scene, progress=progress)
