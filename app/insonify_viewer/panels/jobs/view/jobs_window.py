"""Window that begins jobs and lists them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent, QShowEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QPushButton, QVBoxLayout, QWidget

from insonify.accuracy.charts.kinds import list_chart_kinds
from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.panels.jobs.view.dataset_question import DatasetQuestion
from insonify_viewer.panels.jobs.view.job_row import JobRow
from insonify_viewer.widgets.push_button import push_button
from insonify_viewer.widgets.save_dialogs import Formats, ask_where_to_save, record_formats
from insonify_viewer.widgets.side_panel import ScrollColumn
from insonify_viewer.work.background_job import BackgroundJob

SIZE, SMALLEST = (620, 420), (420, 240)
CHARTS: Formats = (("Pictures", ".png"), ("Drawings", ".svg"), ("Tables", ".csv"), ("Tables", ".json"))
PAGES: Formats = (("Pages", ".html"),)
HINT = "Jobs run beside the window, which stays free. What a command makes here is the same as in a shell, to the bit."


class WantedChart(NamedTuple):
    """A chart to be measured: its kind, and the file to write."""

    kind: str
    path: Path


class JobsView(QWidget):
    """Lists the jobs, the newest first.

    Tab goes from the buttons to the jobs in the order in which they stand, Up and Down go from job to job, Return
    presses a button, and Escape closes the window.
    """

    record_wanted = Signal(object)  # Path
    chart_wanted = Signal(object)  # WantedChart
    dataset_wanted = Signal(object)  # WantedDataset
    stability_wanted = Signal(object)  # Path
    forget_wanted = Signal()
    details_wanted = Signal(object)  # BackgroundJob that failed

    def __init__(self, specifications: list[str]) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setWindowTitle("Jobs · insonify")
        self.resize(*SIZE)
        self.setMinimumSize(*SMALLEST)
        self._specifications = specifications
        self.record = _button("&Record…", "Every ping of the scene, as data or as a picture", self._ask_for_record)
        self.chart = _button("&Chart…", "Error, cost or convergence, measured on this machine")
        self.chart.setMenu(self._charts())
        self.dataset = _button("&Data set…", "Labelled images of many scenes", self._ask_for_dataset)
        self.stability = _button("S&tability…", "The known numerical failures, measured, as a page", self._ask_for_page)
        self.forget = _button("C&lear", "Leave the jobs that have ended out of this list", self.forget_wanted.emit)
        self._hint = QLabel(HINT)
        self._hint.setObjectName("name")
        self._hint.setWordWrap(True)
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

    def _ask_for_record(self) -> None:
        if path := ask_where_to_save(self, "Write the record", "record.nc", record_formats()):
            self.record_wanted.emit(path)

    def _charts(self) -> QMenu:
        """Make a menu of the kinds of charts."""
        menu = QMenu(self)
        for kind in list_chart_kinds():
            menu.addAction(f"{kind.capitalize()}…", partial(self._ask_for_chart, kind))
        return menu

    def _ask_for_chart(self, kind: str) -> None:
        if path := ask_where_to_save(self, f"Measure a chart of {kind}", f"{kind}.png", CHARTS):
            self.chart_wanted.emit(WantedChart(kind, path))

    def _ask_for_dataset(self) -> None:
        question = DatasetQuestion(self._specifications, self)
        if question.exec():
            self.dataset_wanted.emit(question.answer)

    def _ask_for_page(self) -> None:
        if path := ask_where_to_save(self, "Write the page of stability", "stability.html", PAGES):
            self.stability_wanted.emit(path)

    def _lay_out(self) -> None:
        tools = QHBoxLayout()
        for button in (self.record, self.chart, self.dataset, self.stability):
            tools.addWidget(button)
        tools.addStretch(1)
        tools.addWidget(self.forget)
        self._scroll = ScrollColumn()
        self._scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)  # it follows the job that has the keyboard
        self._list = self._scroll.column
        self._list.addStretch(1)
        column = QVBoxLayout(self)
        column.addLayout(tools)
        column.addWidget(self._hint)
        column.addWidget(self._scroll, 1)


def _button(text: str, tip: str, clicked: Callable[[], None] | None = None) -> QPushButton:
    button = push_button(text, tip)
    if clicked is not None:
        button.clicked.connect(lambda: clicked())
    return button
