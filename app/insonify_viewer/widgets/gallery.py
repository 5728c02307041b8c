"""Bundled files to choose from by their pictures."""

from functools import partial

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QIcon
from PySide6.QtWidgets import QDialog, QHBoxLayout, QListView, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from insonify.files import bundled_picture
from insonify_viewer.widgets.buttons import make, push_button
from insonify_viewer.widgets.layouts import fill

PICTURE = QSize(150, 100)  # px, as the files are
CELL = QSize(184, 152)  # px, with three lines of text
HEADING = QSize(4096, 30)  # px: wider than any window, so that it has a line of its own


class Gallery(QDialog):
    """Shows a picture and the title of every file, and signals the path of the one that is clicked.

    Commands that open other files stand above.
    """

    wanted = Signal(str)

    def __init__(self, title: str, window: QWidget, *others: QAction) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(title)
        self.list = choices_list(title)
        self.list.itemClicked.connect(self._pick)
        self.list.itemActivated.connect(self._pick)  # by Enter
        self.list.setGridSize(QSize())
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        buttons = [push_button(action.text(), action.toolTip(), partial(self._leave_for, action)) for action in others]
        above = fill(QHBoxLayout(), *buttons, None) if others else None
        fill(QVBoxLayout(self), *filter(None, [above]), self.list, margins=(6, 6, 6, 6))
        self.resize(QSize(5 * CELL.width() + 40, 4 * CELL.height()).boundedTo(window.window().size()))

    def head(self, subject: str) -> None:
        """Put a heading above the files that are added next."""
        item = QListWidgetItem(subject, self.list)
        font = item.font()
        font.setBold(True)
        item.setFont(font)
        item.setSizeHint(HEADING)
        item.setTextAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignBottom)
        item.setFlags(Qt.ItemFlag.NoItemFlags)

    def add(self, path: str, title: str, tip: str) -> None:
        """Add a file; its tip is a paragraph of HTML, which Qt wraps."""
        add_choice(self.list, path, title, tip, path)

    def _leave_for(self, action: QAction) -> None:
        self.close()
        action.trigger()

    def _pick(self, item: QListWidgetItem) -> None:
        """Close, and signal the path of an item; a double click or a click taken for activation signals once."""
        path = item.data(Qt.ItemDataRole.UserRole)
        if path is not None and self.isVisible():
            self.close()
            self.wanted.emit(path)


def choices_list(name: str) -> QListWidget:
    """Make a list of pictures with names."""
    choices = make(QListWidget, objectName="choices", accessibleName=name, wordWrap=True)
    choices.setViewMode(QListView.ViewMode.IconMode)
    choices.setResizeMode(QListView.ResizeMode.Adjust)
    choices.setMovement(QListView.Movement.Static)
    choices.setIconSize(PICTURE)
    choices.setGridSize(CELL)
    return choices


def add_choice(choices: QListWidget, path: str, title: str, tip: str, value: str) -> None:
    """Add a bundled file that has a picture, and what it stands for."""
    item = QListWidgetItem(QIcon(str(bundled_picture(path))), title, choices)
    item.setData(Qt.ItemDataRole.UserRole, value)
    item.setSizeHint(CELL)
    item.setToolTip(tip)
    item.setTextAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
