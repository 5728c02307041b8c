"""Command palette: finds commands, scenes, lessons and parameters by some letters of their names."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QKeyEvent, QKeySequence
from PySide6.QtWidgets import QDialog, QLineEdit, QListWidget, QListWidgetItem, QMenu, QVBoxLayout, QWidget

from insonify.scene import bundled_scenes, load_scene
from insonify_viewer.panels.panel import Entry
from insonify_viewer.widgets.buttons import make
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.text import literal
from insonify_viewer.widgets.theme import scaled
from insonify_viewer.window.help_dialogs import commands_of

SIZE = 560, 420  # px at the usual size of the text
MOST = 40  # entries that are listed
SCENE = ".toml"  # suffix of the scenes, which are no commands
STEPS: dict[int, int] = {Qt.Key.Key_Down: 1, Qt.Key.Key_Up: -1, Qt.Key.Key_PageDown: 10, Qt.Key.Key_PageUp: -10}


class CommandPalette(QDialog):
    """Lists the entries that have all words of a search, and does the one that the person picks."""

    def __init__(self, window: QWidget, entries: Sequence[Entry]) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle("Find a command, scene, lesson or parameter")
        self._entries, self._found = entries, list(entries)
        self.search = make(QLineEdit, objectName="search", accessibleName="Find", placeholderText=self.windowTitle())
        self.list = make(QListWidget, objectName="choices", accessibleName="Found")
        self.search.textChanged.connect(self._show)
        self.search.returnPressed.connect(self._do)
        self.list.itemClicked.connect(lambda _: self._do())
        self.list.itemActivated.connect(lambda _: self._do())
        fill(QVBoxLayout(self), self.search, self.list, growing=self.list)
        self.resize(*(scaled(self, pixels) for pixels in SIZE))
        self._show("")

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Go through the list by keys that a line of text leaves alone."""
        if (step := STEPS.get(event.key())) is not None:
            row = self.list.currentRow() + step
            self.list.setCurrentRow(min(max(row, 0), self.list.count() - 1))
        else:
            super().keyPressEvent(event)

    def _show(self, words: str) -> None:
        self._found = find_entries(self._entries, words)[:MOST]
        self.list.clear()
        for entry in self._found:
            item = QListWidgetItem(f"{entry.kind}  ·  {entry.name}")
            item.setToolTip(literal(entry.about))
            self.list.addItem(item)
        self.list.setCurrentRow(0)

    def _do(self) -> None:
        """Close, and do the current entry; a double click or a click taken for activation does it once."""
        row = self.list.currentRow()
        if self.isVisible() and 0 <= row < len(self._found):
            self.close()
            self._found[row].do()


def find_entries(entries: Iterable[Entry], words: str) -> list[Entry]:
    """Find the entries that have all words: names that begin with them, then names that have them, then the rest."""
    wanted = words.lower().split()
    found = []
    for entry in entries:
        name, text = entry.name.lower(), f"{entry.kind} {entry.name} {entry.about}".lower()
        if all(word in text for word in wanted):
            rank = 0 if name.startswith(" ".join(wanted)) else 1 if all(word in name for word in wanted) else 2
            found.append((rank, entry))
    return [entry for _, entry in sorted(found, key=lambda pair: pair[0])]


def entries_of_menus(menus: Iterable[QMenu]) -> list[Entry]:
    """Entries for the commands of menus that can be given now, with their keys."""
    return [
        Entry(menu.title().replace("&", ""), _name(action), action.toolTip(), action.trigger)
        for menu in menus
        for action in commands_of(menu)
        if action.text() and action.isEnabled() and not str(action.data()).endswith(SCENE)
    ]


def entries_of_scenes(wanted: Callable[[str], object]) -> list[Entry]:
    """Entries for the bundled scenes; each calls a function with its file."""
    found = []
    for name, path in bundled_scenes().items():
        scene = load_scene(path)
        found.append(Entry("Scene", f"{name}: {scene.title}", scene.about, partial(wanted, str(path))))
    return found


def _name(action: QAction) -> str:
    key = action.shortcut().toString(QKeySequence.SequenceFormat.NativeText)
    return f"{action.text().replace('&', '')}  ({key})" if key else action.text().replace("&", "")
