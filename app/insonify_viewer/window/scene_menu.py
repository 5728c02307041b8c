"""Button and pictures of the bundled scenes, by subject."""

import html

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QToolButton, QWidget

from insonify.scene import bundled_scenes, load_scene
from insonify_viewer.widgets.gallery import Gallery

# Names of scenes, or their beginnings, in the order in which they are shown.
SUBJECTS = {
    "As at sea": ("wreck-site", "wreck", "raw-record", "rough-tow"),
    "Targets and their shadows": ("default", "pipe-", "targets"),
    "Seabeds": ("ripples", "sediments", "rough-ground", "real-bed", "endless"),
    "Bent sound and ghosts": ("thermocline", "double-image", "ghosts"),
    "Figures of the paper": ("figure-",),
    "More": ("",),
    "Where it breaks": ("breaks-",),
}


class SceneButton(QToolButton):
    """Shows the pictures, and signals the scene that the person picks."""

    wanted = Signal(str)

    def __init__(self, *files: QAction) -> None:
        super().__init__(toolButtonStyle=Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.setText("Scenes")
        self.setToolTip("Open a scene by the picture of its record")
        self._files = files
        self.clicked.connect(self.show_pictures)

    def show_pictures(self) -> None:
        """Show the pictures of all scenes, and the commands that open a file."""
        gallery = scene_gallery(self.window(), *self._files)
        gallery.wanted.connect(self.wanted)
        gallery.show()


def scene_gallery(window: QWidget, *files: QAction) -> Gallery:
    """Pictures of the bundled scenes by subject; those on which a method fails come last."""
    gallery = Gallery("Scenes", window, *files)
    ranked = {name: _rank(name) for name in bundled_scenes()}
    for k, subject in enumerate(SUBJECTS):
        named = sorted((rank, name) for name, rank in ranked.items() if rank[0] == k)
        if named:
            gallery.head(subject)
        for _, name in named:
            path = bundled_scenes()[name]
            scene = load_scene(path)
            gallery.add(str(path), scene.title, f"<p><b>{name}</b></p><p>{html.escape(scene.about)}</p>")
    return gallery


def _rank(name: str) -> tuple[int, int]:
    """Place of a scene: of its subject, by the longest name or beginning that fits, and within it."""
    fits = ((len(start), k, m) for k, starts in enumerate(SUBJECTS.values()) for m, start in enumerate(starts)
            if name.startswith(start))  # fmt: skip
    return max(fits)[1:]
