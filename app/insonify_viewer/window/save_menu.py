"""Menu of what can be saved: scene, record, picture of the window."""

from __future__ import annotations

from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu, QToolButton, QWidget


class SaveMenu(QToolButton):
    """A button with one action for each kind of file."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setText("Save")
        self.setToolTip("Save scene, record or window")
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        self.scene = _action(menu, "Save scene…", "The scene as a TOML file, to be opened again", "Ctrl+S")
        self.record = _action(menu, "Save record…", "Every ping of the track, as data or as a picture", "Ctrl+Shift+S")
        self.picture = _action(menu, "Save picture of the window…", "The window as it stands", "Ctrl+P")
        menu.addSeparator()
        self.jobs = _action(menu, "Jobs…", "Charts, data sets and records that are made beside the window", "Ctrl+J")
        window.addActions(menu.actions())
        self.setMenu(menu)


def _action(menu: QMenu, text: str, tip: str, key: str) -> QAction:
    action = QAction(text, menu)
    action.setToolTip(tip)
    action.setShortcut(QKeySequence(key))
    menu.addAction(action)
    return action
