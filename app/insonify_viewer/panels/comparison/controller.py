"""Keeps and opens records as A, shows what B changes, and measures a recording beside the simulated record."""

from pathlib import Path
from typing import Any

from insonify.arrays import Dataset
from insonify.scene import Scene, SceneError, bundled_scenes, load_scene
from insonify_viewer.core_types import Simulation
from insonify_viewer.panels.comparison.view import ComparisonView
from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.record.comparison.arrangement import find_pairs
from insonify_viewer.record.comparison.recording import Recording, describe_point
from insonify_viewer.record.record import RecordGrowth
from insonify_viewer.state.inspection import Mark
from insonify_viewer.work.jobs import BackgroundJob, State

Measured = dict[str, str] | str  # statistics in words by their names, or why there are none


class ComparisonPanel(Panel):
    """Shows record A beside the live record B: what differs, and of a recording its navigation and statistics."""

    name = "comparison"
    title = "A / B"
    place = Place.SIDE

    def __init__(self, workbench: Workbench) -> None:
        self._workbench, self._player, self._comparison = workbench, workbench.recordings, workbench.comparison
        self._executor = workbench.simulator.executor
        self._mark: Mark | None = None  # under the mouse
        self._simulation: Simulation | None = None  # that of the whole record on screen
        self._wanted: dict[str, Any] = {}  # what is to be measured: a recording, a simulation
        self._measured: dict[str, Any] = {}
        self._learning: BackgroundJob | None = None
        workbench.jobs.changed.connect(self._follow_learning)
        self.view = ComparisonView()
        self._player.opened.connect(self._show_recording)
        self._player.pointed.connect(self._show_point)
        self._player.moved.connect(self._follow)
        self._connect()

    @property
    def complete(self) -> bool:
        """Whether record A is there, no scene is being learned, and both records are measured."""
        return not self._comparison.busy and self._learning is None and self._wanted == self._measured

    def record_grown(self, growth: RecordGrowth) -> None:
        """Compare the live record with A, and measure it for itself once it is complete on screen."""
        self._comparison.follow(growth)
        if growth.current and growth.complete and growth.answer.simulation is not self._simulation:
            self._simulation = growth.answer.simulation
            self._measure_simulated()

    def opened(self, shown: bool) -> None:
        """Read the bundled pairs for their menu."""
        if shown:
            self._executor.submit("pairs", find_pairs, self.view.show_pairs)

    def learn(self, file: str) -> None:
        """Learn a scene from the recording, write it to a file, and open it."""
        recording = self._player.recording
        if recording is None or self._learning is not None:
            return
        self.view.learn.setEnabled(False)
        # The recording is read anew at the frequency that is shown.
        known = recording.dataset.attrs
        frequency = ["--frequency", repr(float(known["frequency"]))] if known.get("frequencies") else []
        arguments = ["learn", str(recording.path), "-o", file, *frequency]
        title = f"scene like {recording.path.name}"
        self._learning = self._workbench.jobs.begin(title, arguments, Path(file))
        self._player.wait_for(f"learning a {self._learning.title}")

    def _connect(self) -> None:
        self.view.open.clicked.connect(lambda: self._player.open(self._workbench.ask_for_recording()))
        self.view.keep.clicked.connect(self._comparison.keep)
        self.view.partner.clicked.connect(self._comparison.open_partner)
        self.view.pair_wanted.connect(self.open_pair)
        self.view.back.clicked.connect(self._comparison.return_to_a)
        self.view.leave.clicked.connect(self._comparison.leave)
        self.view.arranged.connect(self._comparison.arrange)
        self._comparison.changed.connect(self._show_a)
        self._comparison.measured.connect(self._show_changes)
        self.view.frequency_wanted.connect(self._open_frequency)
        self.view.learn_wanted.connect(self.learn)

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Show what differs from A."""
        if settled:
            self.view.partner.setEnabled(bool(scene.partner))
            self._show_changes()

    def open_pair(self, name: str) -> None:
        """Open a bundled scene as B and its partner as A."""
        path = bundled_scenes()[name]
        if self._workbench.open_scene(load_scene(path), str(path), ask=True):
            self._comparison.open_partner()

    def _show_a(self) -> None:
        """Show which record is A, and how both are arranged."""
        kept = self._comparison.kept
        self.view.arrangement.setCurrentText(self._comparison.arrangement.value)
        self.view.show_kept(None if kept is None else kept.scene.title)
        self._show_changes()

    def _show_changes(self) -> None:
        """Show which fields differ from a kept record, and what that changes."""
        if self._comparison.kept is not None:
            self.view.show_changes(self._comparison.changes, self._comparison.difference or "measuring …")

    def _follow_learning(self, job: BackgroundJob) -> None:
        """Show how far a scene is learned; open it at the end, unless unsaved changes keep the present one."""
        if job is not self._learning:
            return
        if job.running:
            self._player.wait_for(f"learning a {job.title}", job.stage.share)
            return
        self._learning = None
        self.view.learn.setEnabled(True)
        self._player.wait_for("")
        if job.state is State.DONE and job.result is not None:
            self._workbench.open_scene(load_scene(job.result), str(job.result), ask=True)

    def _open_frequency(self, frequency: float) -> None:
        """Read the present file anew for another frequency."""
        if self._player.recording is not None:
            self._player.open(str(self._player.recording.path), frequency)

    def _show_recording(self, recording: Recording | None) -> None:
        """Show a recording that was opened, or that there is none."""
        if recording is not None or self._comparison.kept is None:
            self.view.show_recording(recording)
        if recording is None:
            self._wanted, self._measured = {}, {}
            return
        self._show_point(None)
        if self._wanted.get("recorded") is not recording:
            self._workbench.open_panel(self.name)
            self._measure("recorded", recording, lambda: measure_record(recording.dataset))
        self._measure_simulated()

    def _show_point(self, mark: Mark | None) -> None:
        """Show the navigation at a point, else at nadir of the ping on top."""
        recording, self._mark = self._player.recording, mark
        if recording is not None:
            self.view.show_point(describe_point(recording, mark or Mark(self._player.top, 0, 0)), at_mouse=bool(mark))

    def _follow(self, _: int) -> None:
        """Show the navigation of the ping on top while the mouse is elsewhere."""
        if self._mark is None:
            self._show_point(None)

    def _measure_simulated(self) -> None:
        simulation = self._simulation
        if simulation is not None and self._player.recording is not None:
            self._measure("simulated", simulation, lambda: measure_simulation(simulation))

    def _measure(self, part: str, what: Any, errand: Any) -> None:
        """Measure a record on its thread, unless that is done or under way."""
        if self._wanted.get(part) is what:
            return
        self._wanted[part] = what
        self.view.show_measured(part, "measuring …")
        self._executor.submit(part, errand, lambda found: self._take(part, what, found))

    def _take(self, part: str, what: Any, found: Measured | None) -> None:
        """Show the statistics of a record, unless another one is wanted by now."""
        if self._wanted.get(part) is what:
            self._measured[part] = what
            self.view.show_measured(part, found or "cannot be measured")


def measure_record(record: Dataset) -> Measured:
    """Measure the statistics of a record; a record with too little bed has a sentence instead."""
    # lazy: loads SciPy on a thread of its own; the window opens before
    from insonify.statistics.record_statistics import measure_statistics

    try:
        return measure_statistics(record).described()
    except SceneError as error:
        return str(error)


def measure_simulation(simulation: Simulation) -> Measured:
    """Measure the statistics of the whole record of a simulation."""
    # lazy: loads xarray on a thread of its own; the window opens before
    from insonify.io.record_schema import join_blocks
    from insonify.record.variables import make_block

    title = {"title": simulation.scene.title}
    blocks = [
        make_block(simulation.scene, simulation.ground, *traced, None, title).to_dataset()
        for traced in simulation.record_blocks()
    ]
    return measure_record(join_blocks(blocks))
