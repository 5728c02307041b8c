"""Status bar: what happened, errors with details to copy, and the progress of jobs."""

import time
from collections import deque
from collections.abc import Callable, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QGuiApplication, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QWidget

from insonify.errors import plain_text
from insonify_viewer.errors import Failure, describe_error, write_details
from insonify_viewer.state.quantities import format_time_left
from insonify_viewer.widgets.buttons import make, push_button
from insonify_viewer.widgets.later import Later
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.text import literal, one_line
from insonify_viewer.work.jobs import BackgroundJob, State

READING_TIME = 12_000  # ms, of a sentence
KEPT = 20  # sentences that are kept for the details of an error
MARGIN = 12  # px beside the words


class StatusLine(QWidget):
    """Shows one sentence; beside that of an error stands a button that copies details."""

    def __init__(self) -> None:
        super().__init__()
        # So narrow that a long sentence does not widen the window.
        self.sentence = make(QLabel, textFormat=Qt.TextFormat.PlainText, minimumWidth=1)
        tip = "Copy program versions, scene and error message, to send with a report"
        self.copy = push_button("Copy details", tip, self._copy, style="small")
        self.copy.hide()
        self.describe_scene: Callable[[], str] = str
        self._failure = Failure("")
        self._said: deque[str] = deque(maxlen=KEPT)
        self._fading = Later(self, READING_TIME)
        fill(QHBoxLayout(self), self.sentence, self.copy, growing=self.sentence, margins=(0, 0, 0, 0))

    def say(self, sentence: str, *, lasting: bool = False) -> None:
        """Show a sentence until the next one, and for some seconds unless it is to last."""
        self._fading.stop()
        if sentence and not lasting:
            self._fading.call(lambda: self.say(""))
        self._show(sentence)
        self.copy.hide()

    def complain(self, error: Failure | Exception, *, lasting: bool = False) -> None:
        """Show the sentence of an error, with the button that copies its details."""
        self._failure = error if isinstance(error, Failure) else describe_error(error)
        self.say(self._failure.sentence, lasting=lasting)
        self.copy.setVisible(bool(self._failure.sentence))

    def show_end(self, job: BackgroundJob) -> None:
        """Show the outcome of a job that has ended."""
        if job.state is State.FAILED:
            self.complain(Failure(job.sentence, job.trace))
        elif not job.running:
            self.say(job.sentence)

    def copy_details(self, failure: Failure) -> None:
        """Copy the details of an error that is shown elsewhere."""
        QGuiApplication.clipboard().setText(write_details(failure, self.describe_scene(), tuple(self._said)))

    def stop(self) -> None:
        """Let the sentence stand; the window closes."""
        self._fading.stop()

    def _copy(self) -> None:
        self.copy_details(self._failure)
        self._fading.call(lambda: self.say(""))
        self._show("copied; paste the details into a report")

    def _show(self, sentence: str) -> None:
        if sentence:
            self._said.append(f"{time.strftime('%H:%M:%S')} {sentence}")
        self.sentence.setText(plain_text(sentence))
        self.sentence.setToolTip(literal(sentence))


class JobBar(QProgressBar):
    """Shows the newest job that runs, and how many others do; hidden while there is none."""

    # With the keyboard in it, Return opens the list of jobs and Delete stops the newest.

    clicked = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("job")
        self.setAccessibleName("Jobs")
        self.setToolTip("Jobs in the background; click to list them (Ctrl+J), Delete stops the newest")
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._newest: BackgroundJob | None = None
        self.setVisible(False)

    def show_jobs(self, running: Sequence[BackgroundJob]) -> None:
        """Show how far the newest of the running jobs is."""
        self.setVisible(bool(running))
        self._newest = running[-1] if running else None
        if not running:
            return
        newest, others = running[-1], len(running) - 1
        share, left = newest.stage.share, newest.seconds_left
        suffix = ("" if left is None else f", {format_time_left(left)} left") + (f" (+{others})" if others else "")
        self.setRange(0, 0 if share is None else 100)
        self.setValue(0 if share is None else int(100 * share))
        room = self.width() - MARGIN - self.fontMetrics().horizontalAdvance(f": 100 %{suffix}")
        title = self.fontMetrics().elidedText(one_line(newest.title), Qt.TextElideMode.ElideRight, max(room, 0))
        self.setFormat(f"{title.replace('%', '')}: %p %{suffix}")  # a percent sign would be read as a place
        self.setAccessibleDescription(f"{newest.title}{suffix}")

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Signal a click."""
        self.clicked.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Signal a click by Return or Space, and stop the newest job by Delete."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space):
            self.clicked.emit()
        elif event.key() == Qt.Key.Key_Delete and self._newest is not None:
            self._newest.stop()
        else:
            super().keyPressEvent(event)
