"""Starts commands on the present scene, and shows what runs and what has ended."""

from pathlib import Path

from insonify.files import bundled_specifications
from insonify_viewer.errors import Failure
from insonify_viewer.panels.jobs.view import JobsView
from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.work.jobs import BackgroundJob


class JobsPanel(Panel):
    """Window of the jobs, with buttons that begin them."""

    name = "jobs"
    title = "Jobs"
    place = Place.WINDOW

    def __init__(self, workbench: Workbench) -> None:
        self._workbench = workbench
        self._jobs = workbench.jobs
        self._jobs.changed.connect(self._show)
        self.view: JobsView | None = None

    @property
    def widget(self) -> JobsView:
        """The window, made on first use."""
        if self.view is None:
            workbench = self._workbench
            self.view = view = JobsView(sorted(bundled_specifications("datasets")))
            view.record_wanted.connect(self.write_record)
            view.chart_wanted.connect(self.measure_chart)
            view.dataset_wanted.connect(self.make_dataset)
            view.stability_wanted.connect(self.write_stability_page)
            view.forget_wanted.connect(self._forget)
            view.details_wanted.connect(lambda job: workbench.copy_details(Failure(job.sentence, job.trace)))
            view.show_jobs(self._jobs.jobs)
        return self.view

    def write_record(self, path: Path) -> None:
        """Write every ping of the present scene, as it is modelled here, as data or as a picture."""
        self._jobs.write_record(self._workbench.session, path)

    def measure_chart(self, kind: str, path: Path) -> None:
        """Measure a chart of the present scene."""
        scene_file = self._jobs.write_scene(self._workbench.session.scene)
        self._jobs.begin(f"chart of {kind}", ["chart", scene_file, "--of", kind, "-o", str(path)], path)

    def make_dataset(self, specification: str, scenes: int, folder: Path) -> None:
        """Make a data set by a specification."""
        arguments = ["dataset", specification, "-o", str(folder), "--scenes", str(scenes)]
        self._jobs.begin(f"data set {folder.name}", arguments, folder)

    def write_stability_page(self, path: Path) -> None:
        """Measure the known numerical failures."""
        self._jobs.begin("stability page", ["stability", "-o", str(path)], path)

    def closing(self) -> None:
        """Close the window."""
        if self.view is not None:
            self.view.close()

    def _show(self, job: BackgroundJob) -> None:
        if self.view is not None:
            self.view.show_job(job)

    def _forget(self) -> None:
        self._jobs.forget_ended()
        self.widget.show_jobs(self._jobs.jobs)
