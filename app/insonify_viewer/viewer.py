"""Connects one window with one session: edits go to the session, changes go to the worker, views and panels."""

import gc
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QObject, QTimer
from PySide6.QtGui import QGuiApplication

from insonify.arrays import Integers
from insonify.display.display_options import PALETTES
from insonify.scene import Scene, SceneError, bundled_scenes, scene_to_toml
from insonify_viewer.core_types import PackedScene
from insonify_viewer.errors import Failure, describe_error
from insonify_viewer.panels.panel import PanelSet, Workbench
from insonify_viewer.record.comparison.comparison import Comparison
from insonify_viewer.record.comparison.recording_player import RecordingPlayer
from insonify_viewer.record.marked_point import MarkController, MarkedPoint
from insonify_viewer.record.record import Record, RecordGrowth, pings_held
from insonify_viewer.record.waterfall_view import Contrast
from insonify_viewer.seabed.controller import SeabedController, silence
from insonify_viewer.state.inspection import Inspection, Mark
from insonify_viewer.state.session import ContactList, Session
from insonify_viewer.state.tow_clock import TowClock, next_pause
from insonify_viewer.widgets.plot import plots_are_drawn
from insonify_viewer.window.file_opening import FileOpening
from insonify_viewer.window.main_window import MainWindow
from insonify_viewer.window.presets import Presets
from insonify_viewer.window.record_menu import RecordMenu
from insonify_viewer.window.saving import Saving
from insonify_viewer.window.seabed_menu import SeabedMenu
from insonify_viewer.window.target_editor import TargetEditor
from insonify_viewer.work.gc_policy import forget_ground, return_free_memory
from insonify_viewer.work.jobs import JobList
from insonify_viewer.work.ping_request import COARSE, FINE, INTERPOLATED, PingRequest, TracedPings, stamp_of
from insonify_viewer.work.simulator import Simulator
from insonify_viewer.work.waiting import WaitingWatch

TICK = 25  # ms
BEHIND = 48  # blank pings on screen at which the tow waits
PATIENCE = 0.25  # s, for each thread when the window closes
REST = 250  # ms without a move of a held slider, after which the planned record is traced
LEAP = 0.2  # s, greatest advance of the tow in one tick, after the window was blocked


class Viewer(QObject):
    """Connects one window with one session."""

    def __init__(self, scene: Scene, *, accelerated: bool, prepare: Any = None) -> None:
        super().__init__()
        self.session = Session(scene)
        self.contacts = ContactList(self.session)
        self.inspection = Inspection()
        self.tow = TowClock(pings_held(scene) - 1)
        self.simulator = Simulator(prepare)
        native = accelerated and QGuiApplication.platformName() == "xcb"
        self.window = MainWindow(native=native, palettes=PALETTES)
        self.simulator.draw = self.window.waterfall.draw_rows
        self.record = Record(pings_held(scene), scene.sonar.bins)
        self.jobs = JobList(self.simulator.executor.call_later)
        self.saving = Saving(self.session, self.contacts, self.window, self.jobs)
        pause = partial(self.run, False)
        self.recordings = RecordingPlayer(self.window, self.session, self.tow, self.simulator.executor, pause=pause)
        self.comparison = Comparison(self.window, self.session, self.simulator, self.recordings)
        self.panels = PanelSet(self._workbench())
        parts = self.recordings, self.contacts, self.saving
        self.files = FileOpening(self.session, self.simulator, self.window, *parts, self.open)
        panel: Any = self.panels["tow"]
        self.files.exercise_opened.connect(panel.open_exercise)
        added = self.panels.part_added.emit
        self.targets = TargetEditor(self.session, self.window, self.simulator, self.files, added)
        self.window.mount(tuple(self.panels.values()))
        self.record_menu = RecordMenu(self.window, self.session, self.inspection)
        self.presets = Presets(self.session, self.window, self.open)
        self.failure = ""
        self.seabed = SeabedController(self.simulator, self.inspection, accelerated=accelerated)
        handles, copies = self.targets.handles, self.record_menu.copies
        self.seabed_menu = SeabedMenu(self.window, self.seabed, self.inspection, handles, copies)
        self.number, self._fine, self._refused = 0, True, -1
        self._traced = (scene, self.session.modelling)
        self.answer: TracedPings | None = None  # the last one that fits the record
        self._laid: PackedScene | None = None  # a scene that is shown before its first pings
        self._waiting = WaitingWatch()
        self._freeing = False  # whether memory of the scene before is still to be returned
        self._prepared = self._started = self._stopped = False
        self.marks = MarkController(self._show_point, self.simulator.executor)
        self._contrast = Contrast(self.window.waterfall, self.session)
        self._clock = QTimer(self, interval=TICK)
        self._ticked = 0.0
        self._rest = QTimer(self, singleShot=True, interval=REST)
        self._rest.timeout.connect(self._ask_finely)
        self._connect()
        self._show_geometry(scene)
        self.panels.scene_changed.emit(scene, True)

    @property
    def complete(self) -> bool:
        """Whether record, seabed and panels show the present scene."""
        shown = self.answer is not None and not self.missing().size
        return shown and self.seabed.complete and self.panels.complete and plots_are_drawn(self.window)

    def start(self) -> None:
        """Start the worker and the clock; the window shows by now."""
        self.simulator.show_first(self.session.scene, lambda _: self.seabed.load(self.window.put_seabed))
        self.simulator.prepare(self.session.scene, self.session.modelling, self._show_first)
        self._ticked = time.perf_counter()
        self._clock.start()

    def _show_first(self, simulation: Any) -> None:
        """Show the scene as soon as it is prepared, before the first pings are traced."""
        self._prepared = True
        if isinstance(simulation, SceneError):
            self._refuse(self.number, describe_error(simulation))
            return
        self.seabed.show_sonar(simulation, self.tow.top, silence(simulation), at_once=True)
        self._ask()

    def _show_laid(self, number: int, packed: PackedScene) -> None:
        """Show a new bed before its first pings are traced."""
        if number == self.number:
            self._laid = packed
            self._show_sonar()

    def find_levels(self) -> None:
        """Set the contrast from the record on screen, without gain."""
        self.session.show("contrast of the record", gain=0.0, levels=None)
        self._contrast.due = True
        self._settle_levels()

    def open(self, scene: Scene, file: str = "") -> None:
        """Open another scene at the start of its track; a tow that paused by itself runs on."""
        self.tow.restart(pings_held(scene) - 1)
        if self._stopped:
            self.run(True)
        self._contrast.due = True
        self.inspection.clear()
        self.seabed.reset_camera()
        self._freeing = True
        self.simulator.send(forget_ground, lambda _: None)
        bundled = Path(file) in bundled_scenes().values()
        if file and not bundled:
            self.window.settings.add_recent(file)
        self.session.open(scene, file, bundled=bundled)
        if not self.missing().size:  # the scene was open already, and its pings are known
            self._show_top()
        self.window.say(scene.title)

    def _frame(self, place: tuple[float, float] | None) -> None:
        """Put the camera on a place of the bed, and keep the record on screen that shows it."""
        self.seabed.reset_camera(place)
        if place is not None:
            self.run(False)

    def run(self, running: bool) -> None:
        """Run or pause the tow."""
        self._stopped = False
        self.window.say("")
        self.tow.run(running)
        self.window.show_running(running)
        self._ask()

    def look_back(self, pings: int) -> None:
        """Move the paused record along the tow."""
        if self.tow.running:
            self.window.say("press Space to pause the tow, then scroll back along it")
            return
        self.tow.look_back(pings)
        self._show_top()

    def go_to(self, ping: int) -> None:
        """Pause, and put a ping on top of the record, with the fish at its place."""
        if self.tow.running:
            self.run(False)
        self.tow.go_to(ping)
        self._show_top()

    def _show_top(self) -> None:
        self.window.waterfall.show_top(self.tow.top)
        self._ask()
        self._show_sonar()

    def close(self) -> None:
        """Stop clock, panels and worker."""
        self._clock.stop()
        self._rest.stop()
        self.panels.closing.emit()
        self.jobs.close(PATIENCE)
        self.simulator.close(PATIENCE)
        self.seabed.close()

    def _workbench(self) -> Workbench:
        """Return what the panels are made with."""

        def open_scene(scene: Scene, file: str, *, ask: bool = False) -> bool:
            if ask and not self.saving.may_leave():
                return False
            self.open(scene, file)
            return True

        def add_actions(actions: Sequence[Any]) -> None:
            self.window.addActions(actions)
            self.window.menus.group("Record", actions)

        return Workbench(
            session=self.session,
            simulator=self.simulator,
            ask_for_file=lambda path: self.files.ask_for(path),
            ask_for_dem=lambda scene: self.files.ask_for_dem(scene),
            ask_for_recording=lambda: self.files.ask_for_recording(),
            keep_recent=lambda path: self.files.keep_recent(path),
            say=self.window.say,
            complain=self.window.complain,
            copy_details=self.window.status.copy_details,
            pause=lambda: self.run(False),
            go_to=self.go_to,
            record_views=(self.window.waterfall, self.window.record_a),
            add_actions=add_actions,
            drape=lambda strip: self.seabed.drape(strip),
            open_panel=self.window.open_panel,
            inspection=self.inspection,
            tow=self.tow,
            jobs=self.jobs,
            recordings=self.recordings,
            comparison=self.comparison,
            contacts=self.contacts,
            open_contacts=lambda: self.files.ask_for_contacts(),
            save_contacts=self.saving.save_contacts,
            report_contacts=self.saving.report_contacts,
            open_scene=open_scene,
            frame=self._frame,
            light_fields=lambda paths: self.panels.fields_lit.emit(paths),
            lecture=self.window.lecture.action.setChecked,
        )

    def _connect(self) -> None:
        window, session = self.window, self.session
        inspection, seabed = self.inspection, self.seabed
        window.waterfall.clicked.connect(inspection.pin)
        inspection.pinned.connect(lambda mark: window.waterfall.show_marks(pin=mark))
        inspection.lit.connect(lambda marks: window.waterfall.show_marks(lit=marks))
        seabed.picked.connect(inspection.pick)
        self.targets.handles.connect_seabed(self.seabed)
        self.seabed.failed.connect(window.complain)
        session.changed.connect(self._scene_changed)
        session.said.connect(window.say)
        session.refused.connect(window.complain)
        window.status.describe_scene = lambda: scene_to_toml(session.scene)
        session.marked.connect(self._show_mark)
        self.simulator.answered.connect(self._take)
        self.simulator.laid.connect(self._show_laid)
        self.simulator.refused.connect(self._refuse)
        window.waterfall.hovered.connect(session.point_at)
        window.waterfall.scrolled.connect(self.look_back)
        window.waterfall.scrubbed.connect(self.go_to)
        window.history.undone.connect(session.undo)
        window.history.redone.connect(session.redo)
        session.changed.connect(lambda _, settled: self._show_edits() if settled else None)
        session.displayed.connect(self._show_edits)
        self.contacts.changed.connect(self._show_edits)
        self._show_edits()
        window.levels.triggered.connect(self.find_levels)
        window.reset_view.triggered.connect(lambda: self.seabed.look_from())
        self.jobs.changed.connect(lambda _: window.jobs.show_jobs(self.jobs.running))
        self.jobs.changed.connect(window.status.show_end)
        prepare = partial(self.simulator.prepare_all, tuple(bundled_scenes().values()))
        window.prepare_all.triggered.connect(lambda: self.jobs.begin_work("preparation of all scenes", prepare))
        window.gain.valueChanged.connect(lambda tenths: session.show(gain=tenths / 10.0))
        window.palettes.activated.connect(lambda _: session.show(palette=window.palettes.currentData()))
        session.displayed.connect(lambda look: window.show_display(look))
        session.displayed.connect(lambda _: self._show_sonar())
        window.speed.activated.connect(lambda _: setattr(self.tow, "speed", window.speed.currentData()))
        window.running_changed.connect(self.run)
        window.lecture.begun.connect(lambda large: self.panels.in_lecture.emit(large))
        window.may_close = self.saving.may_close
        window.closing.connect(self.close)
        self._clock.timeout.connect(self._tick)

    def _scene_changed(self, scene: Scene, settled: bool) -> None:
        traced = (scene, self.session.modelling)
        if traced != self._traced:
            self._contrast.due |= scene.sonar.law != self._traced[0].sonar.law
            self.number += 1
            self._traced = traced
        self._fine = settled
        self._rest.stop() if settled else self._rest.start()
        if not self._holds(scene):
            self.record = Record(pings_held(scene), scene.sonar.bins)
            self.answer = None
            self._show_geometry(scene)
        self.panels.scene_changed.emit(scene, settled)
        self._ask()

    def _show_edits(self) -> None:
        """Show what can be undone and redone, and the title with the star of unsaved changes."""
        self.window.show_title(self.session.scene.title, self.session.file, unsaved=self.saving.unsaved)
        self.window.history.show_edits(self.session.history.undoable, self.session.history.redoable)

    def _tick(self) -> None:
        now = time.perf_counter()
        seconds, self._ticked = min(now - self._ticked, LEAP), now
        self.comparison.tick(seconds)
        self._show_waiting(now)
        self.window.waterfall.show_last(max(self.tow.newest, self.session.scene.track.pings - 1))
        # The tow waits while the kernels compile, and for pings that take long.
        if self.answer is None or self.answer.example or self.record.blank(self.tow.top) > BEHIND:
            return
        before = self.tow.newest
        if self.tow.advance(seconds, self.session.scene.sonar.ping_rate):
            alone = self.recordings.recording is None  # else the tow that pauses would stop the recording too
            tow = self.answer.simulation, before, self.tow.newest, self.record.pings
            if pause := next_pause(*tow, for_targets=alone):
                self.tow.restart(pause.ping)
                self.run(False)
                self._stopped = True
                self.window.say(pause.why)
            self._ask()

    def _show_waiting(self, now: float) -> None:
        """Show what the record waits for, and dim the rows of an earlier scene meanwhile."""
        activity = self.simulator.activity
        if self.number == 0 and self.answer is not None and self.answer.example:
            activity = activity._replace(what=f"example; {activity.what or 'kernels are being compiled'}")
        waiting = self._waiting.look(
            now,
            number=self.number,
            arrived=-1 if self.answer is None else self.answer.number,
            missing=0 if self._refused == self.number else int(self.missing().size),
            shown=len(self.record.shown(self.tow.top)),
            running=self.tow.running,
            activity=activity,
        )
        self.window.waterfall.show_waiting(waiting, stamp_of(self.number, INTERPOLATED))

    def missing(self) -> Integers:
        """Pings on screen that are not yet traced for the present scene."""
        return self.record.missing(self.tow.top, stamp_of(self.number, FINE if self._fine else COARSE))

    def _holds(self, scene: Scene) -> bool:
        return (self.record.pings, self.record.bins) == (pings_held(scene), scene.sonar.bins)

    def _ask(self) -> None:
        """Request the missing pings, unless the scene was refused."""
        missing = self.missing()
        if missing.size and self._prepared and self._refused != self.number:
            request = PingRequest(self.number, self.session.scene, self.session.modelling, missing, self._fine)
            self.simulator.ask(request)

    def _ask_finely(self) -> None:
        """Request the record by its modelling, although the slider is still held."""
        self._fine = True
        self._ask()

    def _take(self, answer: TracedPings) -> None:
        """Take traced pings over, even of a scene that a slider has since left."""
        scene = answer.simulation.scene
        if not self._holds(scene):
            return
        if self.answer is None or scene is not self.answer.simulation.scene:
            self._show_geometry(scene)
        self.answer, self._laid = answer, None
        self.targets.follow(answer.simulation)
        age = self.tow.top - answer.pings
        on_screen = (age >= 0) & (age < self.record.pings)
        whole = bool(on_screen.all())
        some = slice(None) if whole else on_screen  # a mask copies megabytes
        error = None if answer.error is None else answer.error[some]
        place = answer.pings[some], answer.amplitude[some], answer.stamps[some], answer.altitude[some]
        rows = self.record.put(*place, error)
        self._settle_levels()
        drawn, preview = answer.drawn if whole else None, bool(answer.between.any())
        self.window.waterfall.show_rows(rows, answer.reach, preview=preview, drawn=drawn)
        newest = int(self.record.ping.max())  # while the tow runs, the newest ping that has arrived is on top
        self.window.waterfall.show_top(min(self.tow.top, newest) if self.tow.running else self.tow.top)
        if answer.fine:
            self._show_sonar()
        elif not answer.example:
            self.window.waterfall.repaint()  # immediately, because the person who drags a slider watches the record
            self.seabed.show_later(self._show_sonar)
        self._show_mark(self.session.mark)
        if answer.example:
            self._show_sonar()
            return  # panels wait for the plan, which it lacks
        current = answer.fine and answer.number == self.number
        if self._freeing and not self.missing().size:
            self._freeing = False
            gc.collect()  # simulations and beds refer to themselves: few objects, but many megabytes
            self.simulator.send(return_free_memory, lambda _: None)
        self.panels.show_growth(RecordGrowth(answer, self.record, current, complete=not self.missing().size))
        if not self._started:
            self._started = True
            self.window.say(scene.title)

    def _refuse(self, number: int, failure: Failure) -> None:
        """Return from a scene that the core refused to the one before it."""
        if number != self.number:
            return
        self._refused = number
        if not self._started:
            self.failure = failure.sentence
            self.window.complain(failure, lasting=True)
        else:
            self.session.take_back()
            self.panels.scene_refused.emit()
            self.window.complain(failure)

    def _settle_levels(self) -> None:
        """Set the contrast of a newly opened scene, until its record fills the screen."""
        if self.answer is not None:
            self._contrast.settle(self.record, complete=not self.missing().size)

    def _show_geometry(self, scene: Scene) -> None:
        step = scene.track.speed / scene.sonar.ping_rate
        self.window.waterfall.show_record(self.record, scene.sonar.range, step)
        self.window.waterfall.show_top(self.tow.top)

    def _show_mark(self, mark: Mark | None) -> None:
        """Show a point of the record in views and panels."""
        self.marks.show(mark, self.answer, self.record)

    def _show_point(self, point: MarkedPoint | None) -> None:
        self.panels.point_marked.emit(point)
        self.window.waterfall.show_marks(cross=None if point is None else point.mark)
        self.seabed.show_mark(None if point is None else point.position)

    def _show_sonar(self) -> None:
        """Move fish and fan to the ping on top, and colour the scan line by its amplitudes."""
        top = self.window.waterfall.top
        if self._laid is not None:
            self.seabed.show_sonar(self._laid, top, silence(self._laid), at_once=True)
        if self._laid is not None or self.answer is None:
            return
        row = int(self.record.rows(np.array([top]))[0])
        tones = self.window.waterfall.tone_map.tones(self.record.amplitude[row])
        self.seabed.show_sonar(self.answer.simulation, top, tones, at_once=self.answer.example)
