"""Shows records by the display options, measures on them, and keeps contacts."""

import time
from functools import partial
from typing import Any

import numpy as np

from insonify.arrays import Floats, Singles
from insonify.io.contacts import Contact
from insonify.io.georeference import Georeference, find_georeference
from insonify.scene import Scene
from insonify_viewer.core_types import Simulation
from insonify_viewer.panels.panel import Panel, Place, Workbench
from insonify_viewer.panels.record.view import RecordView
from insonify_viewer.record.comparison.recording import Recording
from insonify_viewer.record.drape import RecordStrip
from insonify_viewer.record.measuring import (
    Location,
    Measurement,
    degrees_of,
    locate_recorded,
    locate_simulated,
    measure,
)
from insonify_viewer.record.projection import Zoom, row_factors
from insonify_viewer.record.record import RecordGrowth
from insonify_viewer.record.record_overlays import BinErrors
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.state.inspection import Mark, mark_of
from insonify_viewer.work.newest_wins import NewestWins

SAMPLED = 60_000  # amplitudes that the histogram counts
ERRORS_AT_ONCE = 64  # pings for which errors of bins are estimated before these are drawn
FULL = 3.0  # error, in tolerances, drawn in full colour
OFTEN = 0.25  # s between two histograms of a record that grows
ABOVE = 4  # a contact is shown this part of the screen below its edge


class RecordPanel(Panel):
    """Shows and changes how the simulated record and a recording are displayed."""

    name = "record"
    title = "Record"
    place = Place.SIDE
    rank = 30

    def __init__(self, workbench: Workbench) -> None:
        self._workbench, self._session = workbench, workbench.session
        self._simulated, self._recorded = workbench.record_views
        self._simulation: Simulation | None = None
        self.hovered: tuple[WaterfallView, Mark] | None = None
        self._followed = 0.0  # when histogram and drape last followed the record
        self._draped = False
        self._errors: dict[int, Singles] = {}  # of the bins of pings of a simulation, from far port to far starboard
        self._errors_of: Simulation | None = None
        send = partial(workbench.simulator.executor.submit, "errors of the record")
        self._error_question = NewestWins(
            lambda: self._errors_wanted, send, _bin_errors, self._take_errors, in_turn=True
        )
        self._measured: tuple[WaterfallView, Measurement] | None = None  # the last line, and where
        self.contacts = workbench.contacts
        self.view = RecordView()
        self._connect()

    def record_grown(self, growth: RecordGrowth) -> None:
        """Follow the simulation, and count the levels anew now and then."""
        if growth.answer.simulation is not self._simulation:
            self._simulation = growth.answer.simulation
            self._forget_line(self._simulated)
        now = time.perf_counter()
        if growth.complete or now - self._followed > OFTEN:
            self._followed = now
            self._show_levels()
            self._drape()
            self._show_errors()

    def scene_changed(self, scene: Scene, settled: bool) -> None:
        """Show the contacts of the scene."""
        if settled:
            self._show_contacts()

    def opened(self, shown: bool) -> None:
        """Count the levels of what is shown."""
        if shown:
            self._show_levels()

    def _connect(self) -> None:
        view, session = self.view, self._session
        self._workbench.add_actions(view.keys)
        session.displayed.connect(self._show_display)
        view.changed.connect(lambda options: session.show(**options))
        view.histogram.ends_dragged.connect(self._drag_ends)
        view.errors.toggled.connect(lambda _: self._show_errors())
        view.measuring.connect(self._measure)
        view.zoomed.connect(self._zoom)
        view.contact_wanted.connect(lambda: self._mark_contact(self.hovered))
        for each in (self._simulated, self._recorded):
            each.measured.connect(lambda first, last, each=each: self._show_measured(each, first, last))
            each.hovered.connect(lambda mark, each=each: self._hover(each, mark))
            each.recoloured.connect(self._show_colours)
        self._workbench.recordings.opened.connect(lambda _: self._forget_line(self._recorded))
        self._workbench.recordings.opened.connect(lambda _: self._show_contacts())
        self._workbench.comparison.changed.connect(self._show_marks)
        self.contacts.changed.connect(self._show_contacts)
        listed = view.contacts
        listed.mark.clicked.connect(self._mark_pinned)
        listed.remove_wanted.connect(self.contacts.remove)
        listed.jump_wanted.connect(self._jump)
        listed.chosen.connect(lambda _: self._show_marks())
        listed.edited.connect(self.contacts.edit)
        listed.open.clicked.connect(self._workbench.open_contacts)
        listed.save.clicked.connect(self._workbench.save_contacts)
        listed.report.clicked.connect(self._workbench.report_contacts)
        listed.size_wanted.connect(self._attach_size)

    @property
    def _recording(self) -> Recording | None:
        return self._workbench.recordings.recording

    def _show_display(self, look: Any) -> None:
        self.view.show_display(look)
        self._show_colours()
        self._show_levels()
        self._drape()

    def _drape(self) -> None:
        """Lay the simulated record over the bed, or take it off."""
        wanted, simulation = self._session.display.draped, self._simulation
        if wanted and simulation is not None:
            record = self._simulated.record
            pings = np.sort(record.ping[(record.ping >= 0) & (record.ping <= self._simulated.top)])
            rows = record.rows(pings)
            strip = RecordStrip(
                simulation.poses(pings),
                record.amplitude[rows],
                record.altitude_of(pings),
                simulation.arrays.bin_length,
                self._simulated.tone_map,
            )
            self._workbench.drape(strip)
        elif self._draped:
            self._workbench.drape(None)
        self._draped = wanted

    def _show_errors(self) -> None:
        """Lay the errors of bins over the simulated record, or take them off; some pings more are asked for."""
        record, simulation = self._simulated.record, self._simulation
        if not self.view.errors.isChecked() or simulation is None:
            self._simulated.show_errors(None)
            return
        if self._errors_of is not simulation:
            self._errors, self._errors_of = {}, simulation
        pings = record.shown(self._simulated.top)
        blank = np.zeros(2 * record.bins, np.float32)
        self._errors = {ping: self._errors[ping] for ping in pings.tolist() if ping in self._errors}
        shares = np.stack([self._errors.get(ping, blank) for ping in pings.tolist()])
        full = FULL * self._session.modelling.tolerance
        self._simulated.show_errors(BinErrors(pings, shares, record.altitude_of(pings), full))
        self._error_question.ask()

    @property
    def _errors_wanted(self) -> tuple[Simulation, tuple[int, ...]] | None:
        """The simulation, and the next pings on screen without known errors of bins; None if there are none."""
        record, simulation = self._simulated.record, self._simulation
        if not self.view.errors.isChecked() or simulation is None:
            return None
        shown = record.shown(self._simulated.top)
        traced = shown[record.ping[record.rows(shown)] == shown].tolist()
        lacking = tuple(ping for ping in traced if ping not in self._errors)[:ERRORS_AT_ONCE]
        return (simulation, lacking) if lacking else None

    def _take_errors(self, found: tuple[Simulation, dict[int, Singles]] | None) -> None:
        if found is None or found[0] is not self._simulation:
            return
        self._errors |= found[1]
        if not any(shares.any() for shares in found[1].values()):
            self._workbench.say("the method of this record gives no estimate of the error of its bins")
        self._show_errors()

    def _show_colours(self) -> None:
        """Show the colours of levels, unless the panel is hidden, as before the window shows."""
        if self.view.isVisible():
            self.view.histogram.show_colours(self._simulated.tone_map)

    def _show_levels(self) -> None:
        """Show the levels of the simulated record on screen."""
        if np.any(self._simulated.record.ping >= 0):
            self.view.histogram.show_levels(self._find_levels)
            self._show_colours()

    def _find_levels(self) -> Floats:
        """Levels of some bins of the simulated record on screen, in dB re level bed."""
        record = self._simulated.record
        held = np.flatnonzero(record.ping >= 0)
        every = max(int((held.size * 2 * record.bins / SAMPLED) ** 0.5), 1)
        amplitude = record.amplitude[held[::every], ::every]
        factors = row_factors(self._session.display, record.bins)
        sample = amplitude if factors is None else amplitude * factors[::every]
        return np.asarray(20.0 * np.log10(sample[sample > 0.0].astype(np.float64)))

    def _drag_ends(self, low: float, high: float) -> None:
        """Set the ends of the palette; the gain on top stays."""
        gain = 10.0 ** (self._session.display.gain / 20.0)
        self._session.show(levels=(float(10.0 ** (low / 20.0)) * gain, float(10.0 ** (high / 20.0)) * gain))

    def _measure(self, measuring: bool) -> None:
        for each in (self._simulated, self._recorded):
            each.measuring = measuring
            each.show_marks(line=None)
        self.view.show_measured("")
        if measuring:
            self._workbench.say("drag over the record to measure, or press Return at both ends; M ends measuring")

    def _show_measured(self, view: WaterfallView, first: Mark, last: Mark) -> None:
        ends = self._locate(view, first), self._locate(view, last)
        if ends[0] is not None and ends[1] is not None:
            self._measured = view, measure(ends[0], ends[1])
            words = self._measured[1].words
            view.show_marks(line=(first, last, words))
            self.view.show_measured(words)

    def _forget_line(self, view: WaterfallView) -> None:
        """Forget a line on a record that is replaced."""
        view.show_marks(line=None)
        if self._measured is not None and self._measured[0] is view:
            self._measured = None

    def _attach_size(self, row: int, field: str) -> None:
        """Give a contact a size by the line that was measured last: its length, or the height from a shadow."""
        line = None if self._measured is None else self._measured[1]
        size = None if line is None else line.height if field == "height" else line.straight or line.slant
        if size is None:
            over = "the shadow of the contact, across the track," if field == "height" else "the contact"
            self._workbench.say(f"measure first: press M and drag over {over} then click Take")
        else:
            self.contacts.edit(row, field, round(size, 2))

    def _locate(self, view: WaterfallView, mark: Mark) -> Location | None:
        """Place of a bin of one of the views; None while there is no record."""
        recording, kept = self._recording, self._workbench.comparison.kept
        if view is self._recorded and recording is not None:
            return locate_recorded(recording, mark) if mark.ping < recording.pings else None
        if view is self._recorded:
            simulation = None if kept is None or kept.simulated is None else kept.simulated.simulation
        else:
            simulation = self._simulation
        if simulation is None or mark.bin >= simulation.scene.sonar.bins:
            return None
        return locate_simulated(simulation, mark)

    def _zoom(self, factor: float) -> None:
        """Zoom the record that has the keyboard, else the live one; a record that is linked to it follows."""
        views = self._recorded, self._simulated
        view = next((each for each in views if each.cursor_place is not None), self._simulated)
        if factor:
            view.magnify(factor, view.cursor_place)
        else:
            view.show_zoom(Zoom())

    def _hover(self, view: WaterfallView, mark: Mark | None) -> None:
        self.hovered = None if mark is None else (view, mark)

    def _mark_pinned(self) -> None:
        mark = self._workbench.inspection.mark
        self._mark_contact(None if mark is None else (self._simulated, mark))

    def _mark_contact(self, at: tuple[WaterfallView, Mark] | None) -> None:
        """Add a contact at a bin of one of the views."""
        location = None if at is None else self._locate(*at)
        if at is None or location is None:
            self._workbench.say("point at the record and press C, or click a pixel first")
            return
        view, mark = at
        place = location.place or (None, None)
        degrees = degrees_of(self._georeference(view), location.place) or (None, None)
        self.contacts.add(
            Contact(
                name="",
                note="",
                source=self._source(view),
                ping=mark.ping,
                side=mark.side_name,
                range_bin=mark.bin,
                slant_range=round(location.slant_range, 4),
                ground_range=location.ground_range,
                x=place[0],
                y=place[1],
                longitude=degrees[0],
                latitude=degrees[1],
                snapshot=view.snapshot(mark),
            )
        )
        self._workbench.say(f"marked {self.contacts[-1].name}")

    def _georeference(self, view: WaterfallView) -> Georeference | None:
        if view is self._recorded and self._recording is not None:
            return find_georeference(self._recording.dataset.attrs)
        kept = self._workbench.comparison.kept
        scene = kept.scene if view is self._recorded and kept is not None else self._session.scene
        return scene.georeference

    def _source(self, view: WaterfallView) -> str:
        """State which record a view shows."""
        if view is self._simulated:
            return self._session.scene.title
        kept = self._workbench.comparison.kept
        if self._recording is not None:
            return self._recording.path.name
        return "" if kept is None else kept.scene.title

    def _show_contacts(self) -> None:
        self.view.contacts.show_contacts(self.contacts.all)
        self._show_marks()

    def _show_marks(self) -> None:
        """Draw the contacts of each record over it."""
        chosen = self.view.contacts.row
        for view in (self._simulated, self._recorded):
            source, bins = self._source(view), view.record.bins
            view.show_marks(
                contacts=[
                    (mark_of(each), each.name, row == chosen)
                    for row, each in enumerate(self.contacts.all)
                    if each.source == source and each.range_bin < bins
                ]
            )

    def _jump(self, row: int) -> None:
        """Show a contact some way below the edge of its record."""
        contact = self.contacts[row]
        recorded = self._recording is not None and contact.source == self._recording.path.name
        if not recorded and contact.source != self._session.scene.title:
            self._workbench.say(f"{contact.name} belongs to “{contact.source}”; open that first")
            return
        view = self._recorded if recorded else self._simulated
        ahead = contact.ping + view.record.pings // ABOVE
        if recorded and self._recording is not None:
            self._workbench.recordings.go_to(min(ahead, self._recording.pings - 1))
        else:
            self._workbench.go_to(ahead)
        view.show_zoom(Zoom())
        self.view.contacts.choose(row)


def _bin_errors(simulation: Simulation, pings: tuple[int, ...]) -> tuple[Simulation, dict[int, Singles]]:
    """Errors of the bins of pings as shares of their mean echoes, from far port to far starboard; 0 if not known."""
    # lazy: loads Numba on the thread; the window opens before
    from insonify.explanation.pixel import find_bin_errors

    found = np.nan_to_num(find_bin_errors(simulation, np.array(pings)))
    return simulation, dict(zip(pings, np.concatenate([found[:, 0, ::-1], found[:, 1]], axis=1)))
