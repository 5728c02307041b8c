"""Base of the pictures that stand below the rows of the setting that they show."""

from __future__ import annotations

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QSizePolicy, QWidget

from insonify.scene import Scene


class SettingPicture(QWidget):
    """A picture of a part of the scene, hidden while the scene has nothing to draw there.

    A picture is computed when it is next painted, so that one that is folded away or scrolled out of sight costs
    nothing.

    Parameters
    ----------
    height : int
        In px.
    """

    dragged = Signal(str, object)
    """Dotted path and value while a point of the picture is held."""
    settled = Signal(str, object)
    """Dotted path and value when it is let go."""

    def __init__(self, height: int) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setFixedHeight(height)
        self._scene: Scene | None = None

    def show_scene(self, scene: Scene) -> None:
        """Show another scene."""
        self._scene = scene
        self.setVisible(self.applies(scene))
        self.update()

    def applies(self, scene: Scene) -> bool:
        """Whether a scene has something to draw here."""
        raise NotImplementedError
