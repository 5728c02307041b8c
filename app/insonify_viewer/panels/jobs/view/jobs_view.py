"""Window that begins jobs and lists them."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from PySide6.QtCore import Qt, QUrl, Signal
from PySide6.QtGui import QDesktopServices, QFocusEvent, QKeyEvent, QShowEvent
from PySide6.QtWidgets import (
    QFileDialog,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QMenu,
    QProgressBar,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from insonify.accuracy.charts.kinds import list_chart_kinds
from insonify.io.records import RECORDS
from insonify_viewer.errors import guard_override
from insonify_viewer.state.quantities import format_time_left
from insonify_viewer.widgets.buttons import make_label, push_button
from insonify_viewer.widgets.layouts import fill, fill_grid
from insonify_viewer.widgets.save_dialogs import Formats, ask_where_to_save, record_formats
from insonify_viewer.widgets.side_panel import ScrollColumn
from insonify_viewer.widgets.text import one_line
from insonify_viewer.work.jobs import BackgroundJob, State

STEPS = 1000
SIZE, SMALLEST = (620, 420), (420, 240)
CHARTS: Formats = (("Pictures", ".png"), ("Drawings", ".svg"), ("Tables", ".csv"), ("Tables", ".json"))
PAGES: Formats = (("Pages", ".html"),)
MOSAICS: Formats = (("Maps", ".tif"), ("Pictures for Google Earth", ".kmz"))
HINT = (
    "Jobs run in the background while you go on working. Their results equal, bit for bit, those of the command "
    "insonify in a terminal of this machine."
)


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
        self.title, self.words = make_label("choice", one_line(job.title)), make_label("name")
        self.bar = QProgressBar()
        self.bar.setTextVisible(False)
        self.stop = push_button("Stop", "Stop this job (Delete); no half-written file is left", job.stop)
        self.show_result = push_button("Show", "Open the folder of the result")
        self.show_result.clicked.connect(
            lambda: QDesktopServices.openUrl(QUrl.fromLocalFile(str(Path(str(job.result)).parent)))
        )
        self.copy = push_button("Copy details", "Copy program versions, scene and error message, to send with a report")
        self.copy.clicked.connect(lambda: self.details_wanted.emit(job))
        self.bar.setAccessibleName(f"progress of {job.title}")
        for button in self.buttons:
            button.setAccessibleName(f"{button.text()}: {job.title}")
        rows = [(self.title, self.bar, self.stop), (self.words,)]
        grid = fill_grid(QGridLayout(self), rows, 3, margins=(4, 4, 4, 6))
        grid.setColumnStretch(0, 1)
        for button in self.buttons[1:]:  # in place of the first
            grid.addWidget(button, 0, 2)
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
        """Signal that the row has the keyboard."""
        super().focusInEvent(event)
        self.focused.emit(self)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Stop the job by Delete; signal Up and Down, which the scroll area would take."""
        if event.key() == Qt.Key.Key_Delete:
            self._job.stop()
        elif event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down):
            self.left.emit(1 if event.key() == Qt.Key.Key_Up else -1)
        else:
            super().keyPressEvent(event)


def _words(job: BackgroundJob) -> str:
    """State what the job does now, how much of it is done, and the time left."""
    if job.state is State.STOPPING:
        return "stopping"
    stage, left = job.stage, job.seconds_left
    counted = f"{stage.done:.0f} of {stage.total:.0f} {stage.unit}s" if stage.unit else ""
    share = f"{100.0 * stage.share:.0f} %" if stage.share is not None and not stage.unit else ""
    time_left = "" if left is None else f"{format_time_left(left)} left"
    return ", ".join(part for part in (stage.doing, counted, share, time_left) if part)


class JobsView(QWidget):
    """Lists the jobs, the newest first."""

    # Tab goes from the buttons to the jobs in the order in which they stand, Up and Down go from job to job, Return
    # presses a button, and Escape closes the window.

    record_wanted = Signal(object)  # Path
    chart_wanted = Signal(str, object)  # its kind, and the Path to write
    mosaic_wanted = Signal(object, object)  # list of Path of records, and the Path to write
    survey_wanted = Signal()
    dataset_wanted = Signal()
    stability_wanted = Signal(object)  # Path
    forget_wanted = Signal()
    details_wanted = Signal(object)  # BackgroundJob that failed

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setWindowTitle("Jobs · insonify")
        self.recording = ""  # file of the recording that is open, which is offered to a mosaic
        self.resize(*SIZE)
        self.setMinimumSize(*SMALLEST)
        self.record = push_button(
            "&Record…",
            "Save every ping of the scene as data or as a picture",
            partial(self._ask, "Save the record", "record.nc", record_formats(), self.record_wanted.emit),
        )
        self.chart = push_button("&Chart…", "Measure error, time or convergence of the methods on this computer")
        self.chart.setMenu(self._charts())
        self.survey = push_button("S&urvey…", "Tow over the scene along parallel lines", self.survey_wanted.emit)
        self.mosaic = push_button("&Mosaic…", "Put records on a map, as GeoTIFF or KMZ", self._ask_for_mosaic)
        self.dataset = push_button("&Data set…", "Make labelled pictures to train a detector", self.dataset_wanted.emit)
        self.stability = push_button(
            "S&tability…",
            "Write a page on where methods fail",
            partial(self._ask, "Save the stability page", "stability.html", PAGES, self.stability_wanted.emit),
        )
        self.forget = push_button("C&lear", "Remove finished jobs from the list", self.forget_wanted.emit)
        self._rows: dict[BackgroundJob, JobRow] = {}
        self._lay_out()

    @property
    def rows(self) -> tuple[JobRow, ...]:
        """The rows, the oldest first."""
        return tuple(self._rows.values())

    def show_jobs(self, jobs: list[BackgroundJob]) -> None:
        """Show these jobs and no others."""
        for job in [job for job in self._rows if job not in jobs]:
            row = self._rows.pop(job)
            self._list.removeWidget(row)
            row.deleteLater()
        for job in jobs:
            self.show_job(job)

    def show_job(self, job: BackgroundJob) -> None:
        """Show how far a job is; a new one gets a row on top."""
        if job not in self._rows:
            self._rows[job] = row = JobRow(job)
            row.focused.connect(self._scroll.ensureWidgetVisible)
            row.left.connect(self._go)
            row.details_wanted.connect(self.details_wanted)
            self._list.insertWidget(0, row)
            for each in (*reversed(row.buttons), row):  # each goes right behind the last of the tools
                self.setTabOrder(self.forget, each)
        self._rows[job].show_job(job)

    @guard_override(None)
    def showEvent(self, event: QShowEvent) -> None:
        """Give the keyboard to the newest job, or to the first button where there is none."""
        super().showEvent(event)
        (self.rows[-1] if self._rows else self.record).setFocus()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Close the window, or press the button that has the keyboard."""
        focus, key = self.focusWidget(), event.key()
        if key == Qt.Key.Key_Escape:
            self.close()
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and isinstance(focus, QPushButton):
            focus.click()
        else:
            super().keyPressEvent(event)

    def _go(self, step: int) -> None:
        """Give the keyboard to a newer or an older job than the one that has it."""
        rows = self.rows
        here = next((k for k, row in enumerate(rows) if row.hasFocus()), 0)
        rows[min(max(here + step, 0), len(rows) - 1)].setFocus()

    def _ask(self, title: str, suggestion: str, formats: Formats, wanted: Callable[[Path], None]) -> None:
        """Begin what makes a file, once the person has named it."""
        if path := ask_where_to_save(self, title, suggestion, formats):
            wanted(path)

    def _charts(self) -> QMenu:
        """Make a menu of the kinds of charts."""
        menu = QMenu(self)
        for kind in list_chart_kinds():
            wanted = partial(self.chart_wanted.emit, kind)
            question = partial(self._ask, f"Save the chart of {kind}", f"{kind}.png", CHARTS, wanted)
            menu.addAction(f"{kind.capitalize()}…", question)
        return menu

    def _ask_for_mosaic(self) -> None:
        """Ask for records, and for the file of their mosaic."""
        formats = " ".join(f"*{suffix}" for suffix in RECORDS.readable())
        names, _ = QFileDialog.getOpenFileNames(self, "Records of the mosaic", self.recording, f"Records ({formats})")
        if names:
            wanted = partial(self.mosaic_wanted.emit, [Path(name) for name in names])
            self._ask("Save the mosaic", "mosaic.tif", MOSAICS, wanted)

    def _lay_out(self) -> None:
        buttons = self.record, self.survey, self.mosaic, self.dataset, self.chart, self.stability
        tools = fill(QHBoxLayout(), *buttons, None, self.forget)
        self._scroll = ScrollColumn()
        self._scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # it follows the job that has the keyboard
        self._list = self._scroll.column
        self._list.addStretch(1)
        fill(QVBoxLayout(self), tools, make_label("name", HINT), self._scroll, growing=self._scroll)
