"""Row of one job: what it makes, how far it is, and what can be done about it."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QGridLayout, QLabel, QProgressBar, QWidget

from insonify_viewer.jobs.background_job import BackgroundJob, State
from insonify_viewer.quantities import format_time_left
from insonify_viewer.views.push_button import push_button

STEPS = 1000


class JobRow(QWidget):
    """Shows a job until it is left out of the list."""

    details_wanted = Signal(object)  # BackgroundJob

    def __init__(self, job: BackgroundJob) -> None:
        super().__init__()
        self.title, self.words = QLabel(job.title), QLabel()
        self.title.setObjectName("choice")
        self.words.setObjectName("name")
        self.words.setWordWrap(True)
        self.words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.stop = push_button("Stop", "End this job; nothing half-written is left")
        self.stop.clicked.connect(job.stop)
        self.show_result = push_button("Show", "Open the folder of what was made")
        self.show_result.clicked.connect(lambda: _show_folder(job.result))
        self.copy = push_button("Copy details", "Copy versions, scene and what went wrong, to be sent with a report")
        self.copy.clicked.connect(lambda: self.details_wanted.emit(job))
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 4, 0, 6)
        grid.setColumnStretch(0, 1)
        grid.addWidget(self.title, 0, 0)
        grid.addWidget(self.bar, 0, 1)
        for button in (self.stop, self.show_result, self.copy):
            grid.addWidget(button, 0, 2)
        grid.addWidget(self.words, 1, 0, 1, 3)
        self.show_job(job)

    def show_job(self, job: BackgroundJob) -> None:
        """Show how far the job is."""
        share = job.stage.share
        self.bar.setVisible(job.running)
        self.bar.setRange(0, 0 if share is None else STEPS)
        self.bar.setValue(0 if share is None else int(STEPS * share))
        self.stop.setVisible(job.running)
        self.stop.setEnabled(job.state is State.RUNNING)
        self.show_result.setVisible(job.state is State.DONE and job.result is not None)
        self.copy.setVisible(job.state is State.FAILED)
        self.words.setText(_words(job) if job.running else job.sentence)


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
