"""Menu and pictures of the bundled scenes, and of scene files."""

import html

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QToolButton, QWidget

from insonify.scene import bundled_scenes, load_scene
from insonify_viewer.widgets.gallery import Gallery

FAILURE = "breaks-"  # prefix of scenes on which a method fails


class SceneMenu(QToolButton):
    """Signals the scene that the person picks."""

    wanted = Signal(str)

    def __init__(self, from_file: QAction, recording: QAction) -> None:
        shown, opens = Qt.ToolButtonStyle.ToolButtonTextBesideIcon, QToolButton.ToolButtonPopupMode.InstantPopup
        super().__init__(toolButtonStyle=shown, popupMode=opens)
        self.setText("Scenes")
        self.setToolTip("Open a scene")
        self._files = (from_file, recording)
        self.pictures = QAction("Show pictures of all…", self)
        self.pictures.setToolTip("Pick a scene by its record")
        self.pictures.triggered.connect(self._show_pictures)
        menu = QMenu(self, toolTipsVisible=True)
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
        failures = QMenu("Where it breaks", menu, toolTipsVisible=True)
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
        gallery = scene_gallery(self.window())
        gallery.wanted.connect(self.wanted)
        gallery.show()


def scene_gallery(window: QWidget) -> Gallery:
    """Pictures of the bundled scenes; those on which a method fails come last."""
    gallery = Gallery("Scenes", window)
    for name, path in sorted(bundled_scenes().items(), key=lambda entry: entry[0].startswith(FAILURE)):
        scene = load_scene(path)
        gallery.add(str(path), scene.title, f"<p><b>{name}</b></p><p>{html.escape(scene.about)}</p>")
    return gallery
