"""Menu bar of the window: every command, by what it is about."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QObject
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMainWindow, QMenu


class Menus(QObject):
    """The menus of a window."""

    def __init__(self, window: QMainWindow) -> None:
        super().__init__(window)
        bar = window.menuBar()
        self.file, self.edit = _menu(bar.addMenu("&File")), _menu(bar.addMenu("&Edit"))
        self.view, self.record = _menu(bar.addMenu("&View")), _menu(bar.addMenu("&Record"))
        self.tools, self.help = _menu(bar.addMenu("&Tools")), _menu(bar.addMenu("&Help"))

    @property
    def all(self) -> list[QMenu]:
        """All menus, from left to right."""
        return [self.file, self.edit, self.view, self.record, self.tools, self.help]

    def named(self, title: str) -> QMenu:
        """Menu of a title such as ``View``."""
        menu = getattr(self, title.lower())
        assert isinstance(menu, QMenu)
        return menu

    def add(self, title: str, text: str, tip: str, key: str = "") -> QAction:
        """Append a command to the menu of a title and return its action."""
        menu = self.named(title)
        action = QAction(text, menu)
        action.setShortcut(QKeySequence(key))
        action.setToolTip(tip)
        menu.addAction(action)
        return action

    def group(self, title: str, actions: Sequence[QAction]) -> None:
        """Append actions that exist elsewhere too, apart from those before by a line."""
        menu = self.named(title)
        if menu.actions():
            menu.addSeparator()
        menu.addActions(actions)


def _menu(menu: QMenu) -> QMenu:
    menu.setToolTipsVisible(True)
    return menu
