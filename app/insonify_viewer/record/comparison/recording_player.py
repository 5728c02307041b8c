"""Reads a recording on a thread of its own, and plays it beside the simulated record."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np
from psygnal import Signal
from PySide6.QtGui import QAction

from insonify.scene import SceneError
from insonify_viewer.errors import Failure
from insonify_viewer.record.comparison.comparison_actions import ComparisonActions
from insonify_viewer.record.comparison.comparison_overlay import ComparisonOverlay
from insonify_viewer.record.comparison.record_a_view import RecordAView, RecordsSideBySide
from insonify_viewer.record.comparison.recording import Recording, load_recording
from insonify_viewer.record.record import Record
from insonify_viewer.record.waterfall_view import Contrast, WaterfallView
from insonify_viewer.state.inspection import Mark
from insonify_viewer.state.session import Session
from insonify_viewer.state.tow_clock import TowClock
from insonify_viewer.work.executor import Executor
from insonify_viewer.work.waiting import Waiting

STAMP = 0  # of all rows: a recording does not change


class RecordWindow(Protocol):
    """What the comparison needs of the window that shows both records."""

    waterfall: WaterfallView  # the live record
    record_a: RecordAView
    records: RecordsSideBySide
    overlay: ComparisonOverlay
    comparison: ComparisonActions
    trace: QAction
    levels: QAction

    def say(self, sentence: str, *, lasting: bool = False) -> None:
        """Show a sentence in the status bar."""

    def complain(self, error: Failure | Exception, *, lasting: bool = False) -> None:
        """Show an error in the status bar."""


class RecordingPlayer:
    """Plays a recording by its own ping rate, while the tow runs and as fast as the tow."""

    # A recording is opened with the tow paused and its first screenful shown. To play one that is at its end begins it
    # anew.

    opened = Signal(object)  # the `Recording` on screen, or None
    reading = Signal()
    pointed = Signal(object)  # the `Mark` under the mouse, or None
    clicked = Signal(object)  # the `Mark` that is clicked
    moved = Signal(int)  # the ping on top

    def __init__(
        self, window: RecordWindow, session: Session, tow: TowClock, executor: Executor, *, pause: Callable[[], None]
    ) -> None:
        self.recording: Recording | None = None
        self.failure = ""
        self._window, self._tow, self._executor, self._pause = window, tow, executor, pause
        self._view = window.record_a
        self._record, self._clock = Record(1, 1), TowClock(0)
        self._contrast = Contrast(self._view, session)
        self._reading: set[int] = set()  # numbers of the files that are read; the newest is shown
        self._asked = 0
        self._connect()

    @property
    def top(self) -> int:
        """Ping on top of the screen."""
        return self._clock.top

    @property
    def busy(self) -> bool:
        """Whether a file is being read."""
        return bool(self._reading)

    def open(self, path: str, frequency: float | None = None) -> None:
        """Read a file and show it; an empty path does nothing."""
        if not path:
            return
        self._pause()
        self._window.say("")  # warnings about the file appear while it is read
        self._asked += 1
        self._reading.add(self._asked)
        self.reading.emit()
        self.wait_for(f"reading {Path(path).name}{_size(Path(path))}")
        self._executor.start(
            "recording",
            partial(load_recording, path, frequency),
            done=partial(self._take, self._asked),
            failed=partial(self._refuse, self._asked),
        )

    def close(self) -> None:
        """Leave the recording, or one that is being read."""
        self._asked += 1  # what is read is not the newest any more
        self.wait_for("")
        self.recording, self._record = None, Record(1, 1)
        self.pointed.emit(None)
        self.opened.emit(None)

    def wait_for(self, what: str, share: float | None = None) -> None:
        """Show a bar over the recording with what it waits for and the share done; an empty text removes it."""
        self._view.show_waiting(Waiting(what, share) if what else None, -1)

    def go_to(self, ping: int) -> None:
        """Pause, and put a ping of the recording on top."""
        if self._tow.running:
            self._pause()
        self._clock.go_to(ping)
        self._show_top()

    def look_back(self, pings: int) -> None:
        """Move the paused recording back by some pings, or on."""
        if self.recording is not None and not self._tow.running:
            self.go_to(min(max(self._clock.top - pings, 0), self.recording.pings - 1))

    def tick(self, seconds: float) -> None:
        """Play on by some seconds if the tow runs."""
        if self.recording is None:
            return
        if self._tow.running is not self._clock.running:
            self._run(self._tow.running)
        self._clock.speed = self._tow.speed
        if self._clock.advance(seconds, self.recording.ping_rate):
            if self._clock.newest >= self.recording.pings:
                self._clock.restart(self.recording.pings - 1)
            self._show_top()

    def _connect(self) -> None:
        window, view = self._window, self._view
        view.hovered.connect(self._point_at)
        view.clicked.connect(self._click)
        view.scrolled.connect(self.look_back)
        view.scrubbed.connect(self.go_to)
        window.trace.triggered.connect(view.toggle_trace)
        window.levels.triggered.connect(self._find_levels)

    def _take(self, number: int, recording: Recording) -> None:
        """Show a recording that was read, unless a newer one is being read."""
        if not self._finish(number):
            return
        self.recording, self.failure = recording, ""
        self._record = Record(recording.held, recording.bins)
        self._clock = TowClock(recording.held - 1)
        self._clock.run(False)
        self._view.show_record(self._record, recording.slant_range, recording.step)
        self._view.show_last(recording.pings - 1)
        self._view.overview.fill(np.arange(recording.pings), recording.overview)
        self._show_top()
        self._find_levels()
        self.opened.emit(recording)

    def _refuse(self, number: int, failure: Failure) -> None:
        """Show why a file could not be read, and show what was shown before."""
        if not self._finish(number):
            return
        self.failure = failure.sentence
        self._window.complain(failure, lasting=True)
        self.opened.emit(self.recording)

    def _finish(self, number: int) -> bool:
        """Note that a file was read; return whether it is the newest that was asked for."""
        self._reading.remove(number)
        if number < self._asked:
            return False
        self.wait_for("")
        return True

    def _run(self, running: bool) -> None:
        """Pause, or play on from the ping on top; from the first where that is the last."""
        self._clock.run(running)
        if running and self.recording is not None and self._clock.top >= self.recording.pings - 1:
            self._clock.restart(0)
            self._show_top()

    def _show_top(self) -> None:
        """Put the pings on screen into the record, and show them."""
        assert self.recording is not None
        missing = self._record.missing(self.top, STAMP)
        if missing.size:
            altitude = self.recording.altitude[missing]
            try:
                amplitude = self.recording.amplitude[missing]
            except SceneError as error:  # its file is gone
                self.close()
                self._window.complain(error, lasting=True)
                return
            self._view.show_rows(self._record.put(missing, amplitude, STAMP, altitude))
        self._view.show_top(self.top)
        self.moved.emit(self.top)

    def _find_levels(self) -> None:
        self._contrast.due = True
        self._contrast.settle(self._record, complete=True)

    def _point_at(self, mark: Mark | None) -> None:
        known = None if self.recording is None or (mark and mark.ping >= self.recording.pings) else mark
        self._view.show_marks(cross=mark if self.recording is None else known)
        self.pointed.emit(known)

    def _click(self, mark: Mark) -> None:
        if self.recording is not None and mark.ping < self.recording.pings:
            self.clicked.emit(mark)


def _size(path: Path) -> str:
    """Size of a file in words, empty where there is none."""
    return f", {path.stat().st_size / 1e6:.3g} MB" if path.is_file() else ""
