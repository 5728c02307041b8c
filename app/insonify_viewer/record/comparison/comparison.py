"""Record A beside the live record B: keeps it, traces it, arranges both, and measures what differs."""

from functools import partial

import numpy as np
from psygnal import Signal

from insonify.arrays import Integers
from insonify.scene import Scene, SceneError, load_partner
from insonify_viewer.errors import Failure
from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.record.comparison.kept_record import STAMP, Change, KeptRecord, Traced, list_changes
from insonify_viewer.record.comparison.linked_records import LinkedRecords
from insonify_viewer.record.comparison.record_difference import RecordSnapshot, are_comparable, compare_records
from insonify_viewer.record.comparison.recording import Recording
from insonify_viewer.record.comparison.recording_player import RecordingPlayer, RecordWindow
from insonify_viewer.record.record import Record, RecordGrowth
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.session import Session
from insonify_viewer.work.ping_request import SimulatedScene, TracedPings
from insonify_viewer.work.simulator import Simulator, result_of
from insonify_viewer.work.waiting import Waiting

MOVED = 64  # pings by which a running tow moves on before the difference is measured again
TOLD = 2  # changes that the status bar names


class Comparison:
    """Shows record A, which is kept or recorded, beside the live record B."""

    # A kept record follows the ping on top of B, ping by ping; the pings that it lacks are traced on a thread of their
    # own. A recording is played by `RecordingPlayer`.

    changed = Signal()  # record A, or the arrangement
    measured = Signal()  # the difference

    def __init__(
        self, window: RecordWindow, session: Session, simulator: Simulator, recordings: RecordingPlayer
    ) -> None:
        self.a: KeptRecord | Recording | None = None
        self.arrangement = Arrangement.ALONE
        self.difference = ""
        self._window, self._session, self._simulator, self._recordings = window, session, simulator, recordings
        self._view = window.record_a
        self.links = LinkedRecords(window.waterfall, window.record_a)
        self._executor = simulator.executor
        self._growth: RecordGrowth | None = None
        self._traced: tuple[Scene, Modelling] | None = None  # what the growth was traced for
        self._asked = False  # whether pings of A are on their way
        self._compared: tuple[object, object, int] | None = None
        self._connect()

    @property
    def kept(self) -> KeptRecord | None:
        """Record A if it is a simulated one."""
        return self.a if isinstance(self.a, KeptRecord) else None

    @property
    def titles(self) -> tuple[str, str]:
        """Labels of the two records: their titles, or, where these are alike, the first difference."""
        kept, recording, title = self.kept, self._recordings.recording, self._session.scene.title
        if kept is None:
            return "" if recording is None else recording.path.name, title
        if kept.scene.title == title and (changes := self.changes):
            return f"{changes[0].name} {changes[0].before}", f"{changes[0].name} {changes[0].after}"
        return kept.scene.title, title

    @property
    def changes(self) -> list[Change]:
        """What differs between a kept record A and the scene of B."""
        kept, session = self.kept, self._session
        if kept is None:
            return []
        return list_changes((kept.scene, kept.modelling), (session.scene, session.modelling))

    @property
    def busy(self) -> bool:
        """Whether pings of A are missing on screen, or the difference is being measured."""
        kept = self.kept
        waits = kept is not None and bool(kept.record.missing(self._window.waterfall.top, 0).size)
        return self._recordings.busy or waits or (self._compared is not None and not self.difference)

    def keep(self) -> None:
        """Keep the live record as A."""
        growth = self._growth
        if growth is None or self._traced != (self._session.scene, self._session.modelling):
            self._window.say("the record is not complete yet; keep it as A in a moment")
            return
        self._show_kept(KeptRecord.of(growth.record, self._session.modelling, growth.answer))
        self._window.say("kept as A: hold X to see it, W wipes it over the record, D shows the difference")

    def keep_scene(self, scene: Scene) -> None:
        """Trace another scene as A."""
        self._show_kept(KeptRecord(scene, Modelling(self._session.modelling.tolerance)))

    def open_partner(self) -> None:
        """Trace the partner that the scene names as A."""
        try:
            partner = load_partner(self._session.scene)
        except SceneError as error:
            self._window.complain(error)
            return
        if partner is None:
            self._window.say("this scene is not one of a pair; press K to keep its record as A")
        else:
            self.keep_scene(partner)

    def return_to_a(self) -> None:
        """Return to the scene and the modelling of A, as one step of undo."""
        if (kept := self.kept) is None:
            self._window.say("no scene is kept as A; press K to keep this one")
        else:
            self._session.turn_to(kept.scene, kept.modelling)

    def leave(self) -> None:
        """Leave record A, or a recording that is being read."""
        self._recordings.close()
        if self.a is not None:
            self._set(None)

    def arrange(self, arrangement: Arrangement) -> None:
        """Show both records in another way."""
        self.arrangement = arrangement
        self._lay()
        self.changed.emit()

    def toggle(self, arrangement: Arrangement) -> None:
        """Turn to an arrangement, or back from it."""
        if self.a is None:
            self._window.say("there is no record A; press K to keep this one")
        else:
            self.arrange(Arrangement.ALONE if self.arrangement is arrangement else arrangement)

    def follow(self, growth: RecordGrowth) -> None:
        """Follow pings that the live record has taken over."""
        if not growth.current:
            return
        self._growth, self._traced = growth, (self._session.scene, self._session.modelling)
        kept = self.kept
        if kept is not None and kept.simulated is not None and growth.answer.simulation is kept.simulated.simulation:
            self._copy(kept, growth.answer)
        if growth.complete:
            self._measure()

    def tick(self, seconds: float) -> None:
        """Play a recording on by some seconds, show a kept record with the contrast of B, and draw what has changed."""
        self._recordings.tick(seconds)
        if self.kept is not None:
            self._view.show_levels(self._window.waterfall.levels)
        self._window.overlay.follow()

    def _connect(self) -> None:
        actions = self._window.comparison
        actions.keep.triggered.connect(self.keep)
        actions.partner.triggered.connect(self.open_partner)
        actions.back.triggered.connect(self.return_to_a)
        actions.toggled.connect(self.toggle)
        actions.held.connect(self._window.overlay.hold)
        self._window.waterfall.moved.connect(self._move)
        self._recordings.reading.connect(self._make_room)
        self._recordings.opened.connect(self._take_recording)
        self._session.changed.connect(self._follow_scene)

    def _follow_scene(self, _scene: Scene, settled: bool) -> None:
        if settled and self.a is not None:
            self._name_records()

    def _make_room(self) -> None:
        """Show a recording that is being read side by side, unless another is shown in another way."""
        if not isinstance(self.a, Recording):
            self._set(None)
            self.arrangement = Arrangement.BESIDE
            self._window.records.show()

    def _take_recording(self, recording: Recording | None) -> None:
        """Make a recording A; None closes it."""
        if recording is not None or self.kept is None:
            self._set(recording)

    def _show_kept(self, kept: KeptRecord) -> None:
        """Make a kept record A."""
        if self._recordings.recording is not None or self._recordings.busy:
            self._recordings.close()
        if self.a is None:
            self.arrangement = Arrangement.ALONE
        scene = kept.scene
        self._set(kept)  # first, so that the picture is computed once, for its place
        self._view.show_levels(self._window.waterfall.levels)
        self._view.show_record(kept.record, scene.sonar.range, scene.track.speed / scene.sonar.ping_rate)
        self._move(self._window.waterfall.top)
        self._measure()

    def _set(self, a: KeptRecord | Recording | None) -> None:
        self.a, self.difference, self._compared = a, "", None
        self._asked = False
        if a is None:
            self._view.show_record(Record(1, 1), 1.0, 1.0)  # the one before may take hundreds of megabytes
        self._lay()
        self.changed.emit()

    def _lay(self) -> None:
        """Give record A the room of its arrangement."""
        if self.a is not None and self.arrangement is Arrangement.BESIDE:
            self._window.records.show()
        else:
            self._window.records.hide()
        if self.a is None:
            self._window.overlay.leave()
            self._window.waterfall.show_title("")
        else:
            self._name_records()
            self._window.overlay.arrange(self.arrangement)

    def _name_records(self) -> None:
        """State which record is A and which B, above them where they stand side by side."""
        a, b = self.titles
        self._window.overlay.show_records((a, b), by_ping=self.kept is not None)
        self.links.by_ping = self.kept is not None
        beside = self.arrangement is Arrangement.BESIDE
        self._view.show_title(f"A  {a}" if beside else "")
        self._window.waterfall.show_title(f"B  {b}" if beside else "")

    def _move(self, top: int) -> None:
        """Let a kept record follow the live one."""
        if self.kept is not None:
            self._view.show_top(top)
            self._fill()

    def _fill(self) -> None:
        """Request the next missing pings of A, after its scene."""
        kept = self.kept
        if kept is None or self._asked:
            return
        missing = kept.missing(self._window.waterfall.top)
        self._view.show_waiting(Waiting(f"simulating A: {kept.scene.title}") if missing.size else None, -1)
        if kept.simulated is None:
            self._asked = True
            prepare = partial(self._simulator.simulate_beside, kept.scene, kept.modelling)
            self._executor.submit("record A", partial(result_of, prepare), partial(self._take_scene, kept))
        elif missing.size:
            self._asked = True
            self._executor.submit("record A", partial(kept.trace, missing), partial(self._take_pings, kept, missing))

    def _take_scene(self, kept: KeptRecord, found: SimulatedScene | SceneError) -> None:
        if kept is not self.a:
            return
        self._asked = False
        if isinstance(found, SceneError):
            self._set(None)
            self._window.complain(found)
        else:
            kept.simulated = found
            self._fill()

    def _take_pings(self, kept: KeptRecord, pings: Integers, traced: Traced | None) -> None:
        if kept is not self.a:
            return
        self._asked = False
        if traced is None:
            self._view.show_waiting(None, -1)
            self._window.complain(Failure("record A cannot be simulated any further; keep another one"))
            return
        amplitude, altitude = traced
        self._view.show_rows(kept.record.put(pings, amplitude, STAMP, altitude))
        self._fill()
        if not self._asked:
            self._measure()

    def _copy(self, kept: KeptRecord, answer: TracedPings) -> None:
        """Take pings over that were traced for B by the simulation of A."""
        wanted = np.isin(answer.pings, kept.record.missing(self._window.waterfall.top, 0))
        if wanted.any():
            taken = answer.pings[wanted], answer.amplitude[wanted], STAMP, answer.altitude[wanted]
            self._view.show_rows(kept.record.put(*taken))

    def _measure(self) -> None:
        """Measure on a thread what B changes, unless that is known."""
        kept, growth = self.kept, self._growth
        if kept is None or growth is None or not growth.complete:
            return
        simulation, top = growth.answer.simulation, int(growth.record.ping.max())
        known = self._compared
        if known is not None and known[:2] == (kept, simulation) and abs(top - known[2]) < MOVED:
            return
        if kept.record.missing(self._window.waterfall.top, 0).size:
            return
        is_edit = known is None or known[1] is not simulation
        self._compared, self.difference = (kept, simulation, top), ""
        scene, record = simulation.scene, growth.record
        errand = partial(_compare, kept, scene, record)
        self._executor.submit("difference", errand, partial(self._take_difference, self._compared, is_edit))

    def _take_difference(self, compared: object, is_edit: bool, found: str | None) -> None:
        """Show what B changes, and say it once after an edit."""
        if compared is not self._compared or self.kept is None:
            return
        self.difference = found or "cannot be compared"
        self._name_records()
        changes = self.changes
        if is_edit and changes:
            named = ", ".join(change.in_words() for change in changes)
            what = named if len(changes) <= TOLD else f"A → B, {len(changes)} fields"
            self._window.say(f"{what}: {self.difference}")
        self.measured.emit()


def _compare(kept: KeptRecord, scene: Scene, record: Record) -> str:
    """State what the record of a scene changes against a kept one."""
    if not are_comparable(kept.scene, scene):
        of = [f"{each.sonar.bins} bins of {each.sonar.range:g} m" for each in (kept.scene, scene)]
        return f"not measured, because A has {of[0]} and B {of[1]}"
    difference = compare_records(RecordSnapshot.of(kept.record, kept.scene), RecordSnapshot.of(record, scene))
    return "too few pings in common to be measured" if difference is None else difference.in_words()
