"""Dialogs of the help menu: keys of the window, and what the program is."""

import tomllib

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QGuiApplication, QKeySequence
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLabel,
    QMenu,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from insonify.files import resources
from insonify_viewer.errors import list_versions, version_of
from insonify_viewer.widgets.buttons import make
from insonify_viewer.widgets.layouts import fill

_NATIVE = QKeySequence.SequenceFormat.NativeText
ROOM, HIGH = 60, 640  # px: beside the columns of the list of keys, and its height
LICENCE = "MIT licence: free to use, change and pass on, without warranty."
OTHERS = (
    "It uses Qt by PySide6 (LGPL 3), tqdm and certifi (MPL 2.0), ffmpeg for .mp4 (GPL 3), and packages under BSD, "
    "MIT and Apache licences; docs/licences.md lists them."
)


class KeysDialog(QDialog):
    """Lists every command that has a key, by its menu, and the keys of views."""

    def __init__(self, window: QWidget, menus: list[QMenu]) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle("Keyboard shortcuts")
        self.list = make(QTreeWidget, accessibleName="Keyboard shortcuts")
        self.list.setHeaderLabels(["command", "key"])
        for menu in menus:
            self._add(menu.title().replace("&", ""), [(a.text(), a.shortcut()) for a in commands_of(menu)])
        others = tomllib.loads((resources() / "window" / "keys.toml").read_text(encoding="utf-8"))
        for title, keys in others.items():
            self._add(title, list(keys.items()))
        self.list.expandAll()
        for column in range(2):
            self.list.resizeColumnToContents(column)
        fill(QVBoxLayout(self), self.list, _closing(self))
        self.resize(self.list.columnWidth(0) + self.list.columnWidth(1) + ROOM, HIGH)

    def _add(self, title: str, keys: list[tuple[str, QKeySequence | str]]) -> None:
        shown = [(text, key if isinstance(key, str) else key.toString(_NATIVE)) for text, key in keys]
        if shown := [(text, key) for text, key in shown if key]:
            group = QTreeWidgetItem(self.list, [title])
            for pair in shown:
                QTreeWidgetItem(group, list(pair))


class AboutDialog(QDialog):
    """Describes the program, with versions, licence and citation as text to copy."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle("About insonify")
        copied = Qt.TextInteractionFlag.TextSelectableByMouse | Qt.TextInteractionFlag.TextSelectableByKeyboard
        words = make(QLabel, about(), accessibleName="About insonify", textInteractionFlags=copied)
        buttons = _closing(self)
        self.copy = buttons.addButton("Copy", QDialogButtonBox.ButtonRole.ActionRole)
        self.copy.clicked.connect(lambda: QGuiApplication.clipboard().setText(about()))
        fill(QVBoxLayout(self), words, buttons)


def about() -> str:
    """Describe the program: the versions it runs with, its licence, and how to cite it."""
    return "\n".join(
        [
            "insonify: a side-scan sonar simulator",
            "",
            *list_versions(),
            "",
            LICENCE,
            OTHERS,
            "",
            "To cite it:",
            f"The insonify authors. insonify: a side-scan sonar simulator (version {version_of('insonify')}).",
        ]
    )


def _closing(dialog: QDialog) -> QDialogButtonBox:
    buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
    buttons.rejected.connect(dialog.reject)
    return buttons


def commands_of(menu: QMenu) -> list[QAction]:
    """Commands of a menu and of the menus in it."""
    found: list[QAction] = []
    for action in menu.actions():
        inner = action.menu()
        found += commands_of(inner) if isinstance(inner, QMenu) else [action]
    return found
