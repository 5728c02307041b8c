"""Menu of the files that were opened last."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QWidget

from insonify_viewer.window.settings import Settings


class RecentMenu(QMenu):
    """Signals the recent file that the person picks; files that are gone are marked."""

    wanted = Signal(str)

    def __init__(self, window: QWidget, settings: Settings) -> None:
        super().__init__("Open recent", window)
        self._settings = settings
        self.setToolTipsVisible(True)
        self.aboutToShow.connect(self.fill)
        self.triggered.connect(self._pick)
        self.fill()

    def fill(self) -> None:
        """List the files as they are now."""
        self.clear()
        for file in self._settings.recent:
            gone = "" if Path(file).exists() else "  (no longer there)"
            action = self.addAction(Path(file).name.replace("&", "&&") + gone)
            action.setData(file)
            action.setToolTip(file)
        if self.isEmpty():
            self.addAction("no files yet").setEnabled(False)
        else:
            self.addSeparator()
            self.addAction("Clear the list").setData("")

    def _pick(self, action: QAction) -> None:
        if action.data():
            self.wanted.emit(action.data())
        else:
            self._settings.forget_recent()
