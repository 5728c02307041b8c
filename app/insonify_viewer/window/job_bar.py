"""Bar in the status bar for the jobs that run beside the window."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QProgressBar

from insonify_viewer.state.quantities import format_time_left
from insonify_viewer.work.background_job import BackgroundJob

MARGIN = 12  # px beside the words


class JobBar(QProgressBar):
    """Shows the newest job that runs, and how many others do; hidden while there is none.

    With the keyboard in it, Return opens the list of jobs and Delete stops the newest.
    """

    clicked = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("job")
        self.setAccessibleName("Jobs")
        self.setToolTip("What runs beside the window; click for all of it (Ctrl+J), Delete stops the newest")
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
        told = ("" if left is None else f", {format_time_left(left)} left") + (f" (+{others})" if others else "")
        self.setRange(0, 0 if share is None else 100)
        self.setValue(0 if share is None else int(100 * share))
        self.setFormat(f"{self._shortened(newest.title, f': 100 %{told}')}: %p %{told}")
        self.setAccessibleDescription(f"{newest.title}{told}")

    def _shortened(self, title: str, rest: str) -> str:
        """Shorten a title so that what follows it fits the bar too; a percent sign would be read as a place."""
        room = self.width() - MARGIN - self.fontMetrics().horizontalAdvance(rest)
        return self.fontMetrics().elidedText(title, Qt.TextElideMode.ElideRight, max(room, 0)).replace("%", "")

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Signal a click."""
        del event
        self.clicked.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Signal a click by Return or Space, and stop the newest job by Delete."""
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter, Qt.Key.Key_Space):
            self.clicked.emit()
        elif event.key() == Qt.Key.Key_Delete and self._newest is not None:
            self._newest.stop()
        else:
            super().keyPressEvent(event)
