"""Menu and gallery of the bundled scenes, and of scene files."""

import html

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QAction, QIcon
from PySide6.QtWidgets import QDialog, QListView, QListWidget, QListWidgetItem, QMenu, QToolButton, QVBoxLayout, QWidget

from insonify.scene import bundled_scenes, load_scene, scene_picture

PICTURE = QSize(150, 100)  # px, as the files are
FAILURE = "breaks-"  # prefix of scenes on which a method fails
CELL = QSize(184, 164)  # px, with three lines of text


class SceneMenu(QToolButton):
    """Signals the scene that the person picks."""

    wanted = Signal(str)

    def __init__(self, from_file: QAction, recording: QAction, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setText("Scenes")
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.setToolTip("Open a scene")
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self._files = (from_file, recording)
        self.pictures = QAction("Show pictures of all…", self)
        self.pictures.setToolTip("Pick a scene by its record")
        self.pictures.triggered.connect(self._show_pictures)
        menu = QMenu(self)
        menu.setToolTipsVisible(True)
        menu.aboutToShow.connect(self.fill)
        menu.triggered.connect(self._picked)
        self.setMenu(menu)

    def fill(self) -> None:
        """Fill the menu when it first opens, which takes a moment."""
        menu = self.menu()
        if menu.actions():
            return
        menu.addActions(self._files)
        menu.addAction(self.pictures)
        menu.addSeparator()
        failures = QMenu("Where it breaks", menu)
        failures.setToolTipsVisible(True)
        for name, path in bundled_scenes().items():
            scene = load_scene(path)
            action = QAction(f"{name}\t{scene.title}", menu)
            action.setData(str(path))
            action.setToolTip(f"<p>{html.escape(scene.about)}</p>")  # Qt wraps a paragraph
            (failures if name.startswith(FAILURE) else menu).addAction(action)
        menu.addSeparator()
        menu.addMenu(failures)

    def _picked(self, action: QAction) -> None:
        if path := action.data():
            self.wanted.emit(path)

    def _show_pictures(self) -> None:
        gallery = SceneGallery(self.window())
        gallery.wanted.connect(self.wanted)
        gallery.show()


class SceneGallery(QDialog):
    """Shows a picture and the title of every bundled scene, and signals the file of the one that is clicked."""

    # Scenes on which a method fails come last.

    wanted = Signal(str)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle("Scenes")
        self.list = _make_list()
        for name, path in sorted(bundled_scenes().items(), key=lambda entry: entry[0].startswith(FAILURE)):
            scene = load_scene(path)
            item = QListWidgetItem(QIcon(str(scene_picture(name))), scene.title)
            item.setData(Qt.ItemDataRole.UserRole, str(path))
            item.setToolTip(f"<p><b>{name}</b></p><p>{html.escape(scene.about)}</p>")  # Qt wraps a paragraph
            item.setTextAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
            self.list.addItem(item)
        self.list.itemClicked.connect(self._pick)
        self.list.itemActivated.connect(self._pick)  # by Enter
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addWidget(self.list)
        self.resize(QSize(4 * CELL.width() + 40, 4 * CELL.height()).boundedTo(parent.window().size()))

    def _pick(self, item: QListWidgetItem) -> None:
        """Close, and signal the scene of an item; a double click or a click taken for activation signals once."""
        if self.isVisible():
            self.close()
            self.wanted.emit(item.data(Qt.ItemDataRole.UserRole))


def _make_list() -> QListWidget:
    pictures = QListWidget()
    pictures.setObjectName("scenes")
    pictures.setAccessibleName("Scenes")
    pictures.setViewMode(QListView.ViewMode.IconMode)
    pictures.setResizeMode(QListView.ResizeMode.Adjust)
    pictures.setMovement(QListView.Movement.Static)
    pictures.setIconSize(PICTURE)
    pictures.setGridSize(CELL)
    pictures.setWordWrap(True)
    return pictures
