"""Bundled files to choose from by their pictures."""

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QIcon
from PySide6.QtWidgets import QDialog, QListView, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from insonify.files import bundled_picture
from insonify_viewer.widgets.buttons import make
from insonify_viewer.widgets.layouts import fill

PICTURE = QSize(150, 100)  # px, as the files are
CELL = QSize(184, 164)  # px, with three lines of text


class Gallery(QDialog):
    """Shows a picture and the title of every file, and signals the path of the one that is clicked."""

    wanted = Signal(str)

    def __init__(self, title: str, window: QWidget) -> None:
        super().__init__(window)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(title)
        self.list = choices_list(title)
        self.list.itemClicked.connect(self._pick)
        self.list.itemActivated.connect(self._pick)  # by Enter
        fill(QVBoxLayout(self), self.list, margins=(6, 6, 6, 6))
        self.resize(QSize(4 * CELL.width() + 40, 4 * CELL.height()).boundedTo(window.window().size()))

    def add(self, path: str, title: str, tip: str) -> None:
        """Add a file; its tip is a paragraph of HTML, which Qt wraps."""
        add_choice(self.list, path, title, tip, path)

    def _pick(self, item: QListWidgetItem) -> None:
        """Close, and signal the path of an item; a double click or a click taken for activation signals once."""
        if self.isVisible():
            self.close()
            self.wanted.emit(item.data(Qt.ItemDataRole.UserRole))


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
    item.setToolTip(tip)
    item.setTextAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
