"""Starts commands on the present scene, and shows what runs and what has ended."""

from pathlib import Path
from typing import Any

from insonify.files import bundled_specifications
from insonify.scene import Scene, plain
from insonify_viewer.errors import Failure
from insonify_viewer.panels.jobs.view.jobs_view import JobsView
from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.record.comparison.recording import Recording
from insonify_viewer.state.sections import sections_of
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
            self.view = view = JobsView()
            view.record_wanted.connect(self.write_record)
            view.chart_wanted.connect(self.measure_chart)
            view.survey_wanted.connect(self.ask_for_survey)
            view.mosaic_wanted.connect(self.make_mosaic)
            view.dataset_wanted.connect(self.ask_for_dataset)
            view.stability_wanted.connect(self.write_stability_page)
            view.forget_wanted.connect(self._forget)
            view.details_wanted.connect(lambda job: workbench.copy_details(Failure(job.sentence, job.trace)))
            view.show_jobs(self._jobs.jobs)
            workbench.recordings.opened.connect(self._offer)
            self._offer(workbench.recordings.recording)
        return self.view

    def _offer(self, recording: Recording | None) -> None:
        """Offer the recording that is open to a mosaic."""
        if self.view is not None:
            self.view.recording = "" if recording is None else str(recording.path.resolve())

    def write_record(self, path: Path) -> None:
        """Write every ping of the present scene, as it is modelled here, as data or as a picture."""
        self._jobs.write_record(self._workbench.session, path)

    def measure_chart(self, kind: str, path: Path) -> None:
        """Measure a chart of the present scene."""
        scene_file = self._jobs.write_scene(self._workbench.session.scene)
        self._jobs.begin(f"chart of {kind}", ["chart", scene_file, "--of", kind, "-o", str(path)], path)

    def make_mosaic(self, records: list[Path], path: Path) -> None:
        """Put records on a map."""
        self._jobs.begin(f"mosaic {path.name}", ["mosaic", *map(str, records), "-o", str(path)], path)

    def ask_for_survey(self) -> None:
        """Ask for the lines of a survey of the present scene, and tow along them."""
        # lazy: loads Numba; the window opens before
        from insonify.surveys.lines.summary import PAGE
        from insonify_viewer.panels.jobs.view.questions import SurveyQuestion

        scene = self._workbench.session.scene
        question = SurveyQuestion(scene, self.widget)
        if question.exec():
            specification = self._jobs.write_specification(scene, question.answer)
            arguments = ["survey", specification, "-o", str(question.folder)]
            self._jobs.begin(f"survey {question.folder.name}", arguments, question.folder / PAGE)

    def ask_for_dataset(self) -> None:
        """Ask for a data set, by a specification or of the present scene, and make it."""
        # lazy: loads Numba; the window opens before
        from insonify_viewer.panels.jobs.view.questions import DatasetQuestion

        scene = self._workbench.session.scene
        question = DatasetQuestion(sorted(bundled_specifications("datasets")), sections_of(scene), self.widget)
        if question.exec():
            name = question.specification_name
            name = name or self._jobs.write_specification(scene, _specify(scene, question.ranges))
            arguments = ["dataset", name, "-o", str(question.folder), "--scenes", str(question.scenes.value())]
            self._jobs.begin(f"data set {question.folder.name}", arguments, question.folder)

    def write_stability_page(self, path: Path) -> None:
        """Measure the known numerical failures."""
        self._jobs.begin("stability page", ["stability", "-o", str(path)], path)

    def _show(self, job: BackgroundJob) -> None:
        if self.view is not None:
            self.view.show_job(job)

    def _forget(self) -> None:
        self._jobs.forget_ended()
        self.widget.show_jobs(self._jobs.jobs)


def _specify(scene: Scene, ranges: dict[str, Any]) -> dict[str, Any]:
    """Specify a data set of a scene: its targets are put elsewhere in each, in classes by their kinds or meshes."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for target in plain(scene).get("targets", []):
        shape = {name: value for name, value in target.items() if name not in ("position", "locked")}
        groups.setdefault(Path(shape.get("path", shape["kind"])).stem, []).append(shape)
    targets = [{"name": name, "of": shapes, "count": len(shapes)} for name, shapes in groups.items()]
    return {"title": scene.title, "set": {"targets": [], **ranges}, "targets": targets}
