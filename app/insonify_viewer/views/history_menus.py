"""Undo and redo by name: tooltips with the next edit, and menus of all edits."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QObject, QSignalBlocker, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QMenu

MOST = 20  # edits in a menu


class HistoryMenus(QObject):
    """Names what the actions for undo and redo would do; held or clicked by the right button they list all edits.

    Parameters
    ----------
    undo, redo : QAction
        The actions.
    """

    undone = Signal(int)  # steps
    redone = Signal(int)

    def __init__(self, undo: QAction, redo: QAction) -> None:
        super().__init__(undo.parent())
        self._actions = undo, redo
        self._words = undo.text(), redo.text()
        for action, signal in zip(self._actions, (self.undone, self.redone), strict=True):
            action.setIconText(action.text())  # the tool bar shows this; menus show the name of the edit too
            action.triggered.connect(lambda _, signal=signal: signal.emit(1))
            menu = QMenu()
            menu.triggered.connect(lambda chosen, signal=signal: signal.emit(chosen.data()))
            action.setMenu(menu)

    def show_edits(self, undoable: Sequence[str], redoable: Sequence[str]) -> None:
        """Show the names of the edits that can be undone and redone, the next first."""
        for action, word, edits in zip(self._actions, self._words, (undoable, redoable), strict=True):
            with QSignalBlocker(action):
                key = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
                name = f"{word}: {edits[0]}" if edits else f"{word}: nothing"
                action.setText(name)
                action.setIconText(word)
                action.setToolTip(f"{name} ({key})")
            action.setEnabled(bool(edits))
            _fill(action, word, edits)


def _fill(action: QAction, word: str, edits: Sequence[str]) -> None:
    """List edits in the menu of an action; an entry undoes or redoes all down to it."""
    menu = action.menu()
    assert isinstance(menu, QMenu)
    menu.clear()
    for steps, edit in enumerate(edits[:MOST], 1):
        entry = menu.addAction(f"{word}: {edit}")
        entry.setData(steps)
