"""Menu of the three-dimensional view under the right mouse button, and its commands in the menu bar."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, QPoint, Qt
from PySide6.QtGui import QAction, QGuiApplication
from PySide6.QtWidgets import QFileDialog, QMenu

from insonify_viewer.seabed.cameras import CAMERAS
from insonify_viewer.seabed.controller import SeabedController
from insonify_viewer.seabed.target_handles import TargetHandles
from insonify_viewer.state.inspection import Inspection
from insonify_viewer.widgets.buttons import make_action
from insonify_viewer.window.main_window import MainWindow

MOSAICS = "Mosaics (*.tif *.tiff);;All files (*)"
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
            make_action(window, name, f"See the bed {name[:1].lower()}{name[1:]}", do=partial(seabed.look_from, name))
            for name in CAMERAS
        ]
        tip = "See the chosen target from near, and in the record"
        frame = make_action(window, "Frame the target", tip, do=handles.frame)
        self.follow = make_action(window, "Follow the towfish", "The camera moves with the towfish")
        depths = make_action(window, "Depth colours", "Colour the bed by its depth, not its materials")
        tip = "Show what targets hide from the sonar, ping by ping as it passes"
        shadows = make_action(window, "Acoustic shadows", tip)
        tip = "Lay a mosaic, or other levels in a GeoTIFF, over the bed"
        self.mosaic = make_action(window, "Mosaic on the bed…", tip)
        ticked = self.follow, depths, shadows, self.mosaic
        shown = self._let_follow, seabed.colour_by_depth, seabed.show_shadows, self._lay_mosaic
        for action, do in zip(ticked, shown, strict=True):
            action.setCheckable(True)
            action.triggered.connect(do)
        tip = "Copy the 3-D view, at 300 dots per inch"
        picture = make_action(window, "Copy picture of the 3-D view", tip, do=self._copy_picture)
        self._groups = [*self.cameras, frame], ticked, [picture, *copies[1:]]
        camera = window.menus.view.addMenu("Camera")
        camera.setToolTipsVisible(True)
        camera.addActions(self._groups[0])
        window.menus.group("View", self._groups[1])
        window.menus.edit.insertAction(copies[1], picture)
        window.menus.view.aboutToShow.connect(self._show_ticks)
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
        self._show_ticks()
        for group in self._groups:
            menu.addSeparator()
            menu.addActions(group)
        menu.popup(at)
        return menu

    def _show_ticks(self) -> None:
        """Tick whether the camera follows, which to frame a target ends, and whether there is a mosaic."""
        self.follow.setChecked(self._seabed.view is None or self._seabed.view.follows)
        self.mosaic.setChecked(self._seabed.mosaic is not None)

    def _let_follow(self, follows: bool) -> None:
        if self._seabed.view is not None:
            self._seabed.view.follows = follows

    def _lay_mosaic(self, laid: bool) -> None:
        """Lay a mosaic that the person picks over the bed, or take it off."""
        if laid:
            path, _ = QFileDialog.getOpenFileName(self._window, "Mosaic on the bed", "", MOSAICS)
            if path:
                self._seabed.open_mosaic(Path(path))
        else:
            self._seabed.lay_mosaic(None)
        self._show_ticks()

    def _copy_picture(self) -> None:
        if self._seabed.view is not None:
            QGuiApplication.clipboard().setImage(self._seabed.view.picture())
            self._window.say("copied the picture of the 3-D view, 300 dots per inch")
