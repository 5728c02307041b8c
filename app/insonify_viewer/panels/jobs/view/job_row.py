"""Row of one job: what it makes, how far it is, and what can be done about it."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QFocusEvent, QKeyEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QProgressBar, QPushButton

from insonify_viewer.state.quantities import format_time_left
from insonify_viewer.widgets.push_button import push_button
from insonify_viewer.work.background_job import BackgroundJob, State

STEPS = 1000


class JobRow(QFrame):
    """Shows a job until it is left out of the list; with the keyboard in it, Delete stops the job."""

    details_wanted = Signal(object)  # BackgroundJob
    focused = Signal(object)  # the row itself
    left = Signal(int)  # by Up to a newer job, 1, or by Down to an older one, -1

    def __init__(self, job: BackgroundJob) -> None:
        super().__init__()
        self.setObjectName("job")
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._job = job
        self.title, self.words = QLabel(job.title), QLabel()
        self.title.setObjectName("choice")
        self.words.setObjectName("name")
        self.words.setWordWrap(True)
        self.words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.stop = push_button("Stop", "End this job (Delete); nothing half-written is left")
        self.stop.clicked.connect(job.stop)
        self.show_result = push_button("Show", "Open the folder of what was made")
        self.show_result.clicked.connect(lambda: _show_folder(job.result))
        self.copy = push_button("Copy details", "Copy versions, scene and what went wrong, to be sent with a report")
        self.copy.clicked.connect(lambda: self.details_wanted.emit(job))
        self.bar.setAccessibleName(f"progress of {job.title}")
        for button in self.buttons:
            button.setAccessibleName(f"{button.text()}: {job.title}")
        grid = QGridLayout(self)
        grid.setContentsMargins(4, 4, 4, 6)
        grid.setColumnStretch(0, 1)
        grid.addWidget(self.title, 0, 0)
        grid.addWidget(self.bar, 0, 1)
        for button in self.buttons:
            grid.addWidget(button, 0, 2)
        grid.addWidget(self.words, 1, 0, 1, 3)
        self.show_job(job)

    @property
    def buttons(self) -> tuple[QPushButton, ...]:
        """What can be done about the job; no more than one of them is shown."""
        return self.stop, self.show_result, self.copy

    def show_job(self, job: BackgroundJob) -> None:
        """Show how far the job is."""
        if self.stop.hasFocus() and job.state is not State.RUNNING:
            self.setFocus()  # Qt would pass the keyboard on to another job
        share = job.stage.share
        self.bar.setVisible(job.running)
        self.bar.setRange(0, 0 if share is None else STEPS)
        self.bar.setValue(0 if share is None else int(STEPS * share))
        self.stop.setVisible(job.running)
        self.stop.setEnabled(job.state is State.RUNNING)
        self.show_result.setVisible(job.state is State.DONE and job.result is not None)
        self.copy.setVisible(job.state is State.FAILED)
        self.words.setText(_words(job) if job.running else job.sentence)
        self.setAccessibleName(f"{job.title}: {self.words.text()}")

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Tell that the row has the keyboard."""
        super().focusInEvent(event)
        self.focused.emit(self)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Stop the job by Delete; tell of Up and Down, which the scroll area would take."""
        if event.key() == Qt.Key.Key_Delete:
            self._job.stop()
        elif event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self.left.emit(1 if event.key() == Qt.Key.Key_Up else -1)
        else:
            super().keyPressEvent(event)


def _show_folder(result: Path | None) -> None:
    if result is not None:
        QDesktopServices.openUrl(QUrl.fromLocalFile(str(result.parent)))


def _words(job: BackgroundJob) -> str:
    """Say what the job does now, how much of it is done, and the time left."""
    if job.state is State.STOPPING:
        return "stopping"
    stage, left = job.stage, job.seconds_left
    counted = f"{stage.done:.0f} of {stage.total:.0f} {stage.unit}s" if stage.unit else ""
    share = f"{100.0 * stage.share:.0f} %" if stage.share is not None and not stage.unit else ""
    told = "" if left is None else f"{format_time_left(left)} left"
    return ", ".join(part for part in (stage.doing, counted, share, told) if part)
