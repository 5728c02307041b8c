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
        self.list = make(QListWidget, objectName="choices", accessibleName=title, wordWrap=True)
        self.list.setViewMode(QListView.ViewMode.IconMode)
        self.list.setResizeMode(QListView.ResizeMode.Adjust)
        self.list.setMovement(QListView.Movement.Static)
        self.list.setIconSize(PICTURE)
        self.list.setGridSize(CELL)
        self.list.itemClicked.connect(self._pick)
        self.list.itemActivated.connect(self._pick)  # by Enter
        fill(QVBoxLayout(self), self.list, margins=(6, 6, 6, 6))
        self.resize(QSize(4 * CELL.width() + 40, 4 * CELL.height()).boundedTo(window.window().size()))

    def add(self, path: str, title: str, tip: str) -> None:
        """Add a file; its tip is a paragraph of HTML, which Qt wraps."""
        item = QListWidgetItem(QIcon(str(bundled_picture(path))), title, self.list)
        item.setData(Qt.ItemDataRole.UserRole, path)
        item.setToolTip(tip)
        item.setTextAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)

    def _pick(self, item: QListWidgetItem) -> None:
        """Close, and signal the path of an item; a double click or a click taken for activation signals once."""
        if self.isVisible():
            self.close()
            self.wanted.emit(item.data(Qt.ItemDataRole.UserRole))
