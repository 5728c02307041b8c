"""Menu of the three-dimensional view under the right mouse button, and its commands in the menu bar."""

from collections.abc import Callable, Sequence
from functools import partial

from PySide6.QtCore import QObject, QPoint, Qt
from PySide6.QtGui import QAction, QGuiApplication
from PySide6.QtWidgets import QMenu

from insonify_viewer.seabed.cameras import CAMERAS
from insonify_viewer.seabed.controller import SeabedController
from insonify_viewer.seabed.target_handles import TargetHandles
from insonify_viewer.state.inspection import Inspection
from insonify_viewer.widgets.buttons import make_action
from insonify_viewer.window.main_window import MainWindow

Place = tuple[float, float, float]


class SeabedMenu(QObject):
    """Offers what can be done with a place of the bed and with the view of it."""

    def __init__(
        self,
        window: MainWindow,
        seabed: SeabedController,
        inspection: Inspection,
        handles: TargetHandles,
        copies: Sequence[QAction],
    ) -> None:
        super().__init__(window)
        self._window, self._seabed, self._inspection, self._handles = window, seabed, inspection, handles
        self.cameras = [
            self._action(camera, f"See the bed {camera[:1].lower()}{camera[1:]}", partial(seabed.look_from, camera))
            for camera in CAMERAS
        ]
        frame = self._action("Frame the target", "See the chosen target from near, and in the record", handles.frame)
        self.follow = self._tick("Follow the towfish", "The camera moves with the towfish", self._let_follow)
        depths = self._tick("Depth colours", "Colour the bed by its depth, not its materials", seabed.colour_by_depth)
        tip = "Show what targets hide from the sonar, ping by ping as it passes"
        shadows = self._tick("Acoustic shadows", tip, seabed.show_shadows)
        tip = "Copy the 3-D view, at 300 dots per inch"
        picture = self._action("Copy picture of the 3-D view", tip, self._copy_picture)
        self._groups = [*self.cameras, frame], [self.follow, depths, shadows], [picture, *copies[1:]]
        camera = window.menus.view.addMenu("Camera")
        camera.setToolTipsVisible(True)
        camera.addActions(self._groups[0])
        window.menus.group("View", self._groups[1])
        window.menus.edit.insertAction(copies[1], picture)
        window.menus.view.aboutToShow.connect(self._show_follow)
        self.follow.setChecked(True)
        seabed.menu_wanted.connect(self.open)

    def open(self, place: Place | None, at: QPoint) -> QMenu:
        """Open the menu for a place of the bed or of a target, None beside them, at a place of the screen."""
        menu = QMenu(self._window)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        if place is not None:
            for text, do in (
                ("Light up the pixels that receive its echo", self._inspection.pick),
                ("Show this place in the record", self._handles.show_in_record),
            ):
                menu.addAction(text).triggered.connect(lambda _=False, do=do: do(place))
        self._show_follow()
        for group in self._groups:
            menu.addSeparator()
            menu.addActions(group)
        menu.popup(at)
        return menu

    def _action(self, text: str, tip: str, do: Callable[[], object]) -> QAction:
        action = make_action(self._window, text, tip)
        action.triggered.connect(lambda: do())
        return action

    def _tick(self, text: str, tip: str, do: Callable[[bool], object]) -> QAction:
        action = make_action(self._window, text, tip)
        action.setCheckable(True)
        action.triggered.connect(do)
        return action

    def _show_follow(self) -> None:
        """Tick whether the camera follows: to frame a target ends it."""
        self.follow.setChecked(self._seabed.view is None or self._seabed.view.follows)

    def _let_follow(self, follows: bool) -> None:
        if self._seabed.view is not None:
            self._seabed.view.follows = follows

    def _copy_picture(self) -> None:
        if self._seabed.view is not None:
            QGuiApplication.clipboard().setImage(self._seabed.view.picture())
            self._window.say("copied the picture of the 3-D view, 300 dots per inch")
