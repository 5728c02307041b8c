"""Sentences at the bottom of the window: what happened, and errors with details to copy."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from PySide6.QtCore import QTimer
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QHBoxLayout, QLabel, QWidget

from insonify_viewer.errors.error_details import write_details
from insonify_viewer.errors.failure import Failure, describe_error
from insonify_viewer.widgets.push_button import push_button
from insonify_viewer.work.background_job import BackgroundJob, State

READING_TIME = 12_000  # ms, of a sentence
KEPT = 20  # sentences that are kept for the details of an error


class StatusLine(QWidget):
    """Shows one sentence; beside that of an error stands a button that copies details."""

    def __init__(self) -> None:
        super().__init__()
        self.sentence = QLabel()
        self.sentence.setMinimumWidth(1)  # so that a long sentence does not widen the window
        self.copy = push_button(
            "Copy details", "Copy versions, scene and what went wrong, to be sent with a report", style="small"
        )
        self.copy.clicked.connect(self._copy)
        self.copy.hide()
        self.describe_scene: Callable[[], str] = str
        self._failure = Failure("")
        self._said: deque[str] = deque(maxlen=KEPT)
        self._fading = QTimer(self)
        self._fading.setSingleShot(True)
        self._fading.setInterval(READING_TIME)
        self._fading.timeout.connect(lambda: self.say(""))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.sentence, 1)
        row.addWidget(self.copy)

    def say(self, sentence: str, *, lasting: bool = False) -> None:
        """Show a sentence until the next one, and for some seconds unless it is to last."""
        self._fading.stop()
        if sentence and not lasting:
            self._fading.start()
        self._show(sentence)
        self.copy.hide()

    def complain(self, error: Failure | Exception, *, lasting: bool = False) -> None:
        """Show the sentence of an error, with the button that copies its details."""
        self._failure = error if isinstance(error, Failure) else describe_error(error)
        self.say(self._failure.sentence, lasting=lasting)
        self.copy.setVisible(bool(self._failure.sentence))

    def show_end(self, job: BackgroundJob) -> None:
        """Say what came of a job, once it has ended."""
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
        self._fading.start()
        self._show("copied; paste the details into a report")

    def _show(self, sentence: str) -> None:
        if sentence:
            self._said.append(f"{time.strftime('%H:%M:%S')} {sentence}")
        self.sentence.setText(sentence)
        self.sentence.setToolTip(sentence)
