"""Undo and redo by name: tooltips with the next edit, and menus of all edits."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu, QToolButton

MOST = 20  # edits in a menu


class HistoryMenus(QObject):
    """Names what undo and redo would do; their tool buttons, held, list all edits."""

    undone = Signal(int)  # steps
    redone = Signal(int)

    def __init__(self, undo: tuple[QAction, QToolButton], redo: tuple[QAction, QToolButton]) -> None:
        super().__init__(undo[0].parent())
        self._actions = undo[0], redo[0]
        self._words = undo[0].text(), redo[0].text()
        self.lists = QMenu(undo[1]), QMenu(redo[1])
        for (action, button), menu, signal in zip((undo, redo), self.lists, (self.undone, self.redone), strict=True):
            action.triggered.connect(lambda _, signal=signal: signal.emit(1))
            menu.triggered.connect(lambda chosen, signal=signal: signal.emit(chosen.data()))
            button.setMenu(menu)
            button.setPopupMode(QToolButton.ToolButtonPopupMode.DelayedPopup)

    def show_edits(self, undoable: Sequence[str], redoable: Sequence[str]) -> None:
        """Show the names of the edits that can be undone and redone, the next first."""
        for action, menu, word, edits in zip(self._actions, self.lists, self._words, (undoable, redoable), strict=True):
            key = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
            name = f"{word}: {edits[0]}" if edits else word
            action.setText(name)
            action.setIconText(word)  # which the tool bar shows
            action.setToolTip(f"{name} ({key})")
            action.setEnabled(bool(edits))
            _fill(menu, word, edits)


def _fill(menu: QMenu, word: str, edits: Sequence[str]) -> None:
    """List edits in a menu; an entry undoes or redoes all down to it."""
    menu.clear()
    for steps, edit in enumerate(edits[:MOST], 1):
        entry = menu.addAction(f"{word}: {edit}")
        entry.setData(steps)
