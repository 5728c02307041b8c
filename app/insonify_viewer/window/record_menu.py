"""Menu of a record under the right mouse button, and what copies its picture and its scene."""

from collections.abc import Sequence

from PySide6.QtCore import QObject, QPoint, Qt
from PySide6.QtGui import QAction, QGuiApplication, QImage
from PySide6.QtWidgets import QMenu, QWidget

from insonify.scene import scene_to_toml
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.state.inspection import Inspection, Mark
from insonify_viewer.state.session import Session
from insonify_viewer.widgets.buttons import make_action
from insonify_viewer.window.main_window import MainWindow

RESOLUTION, USUAL = 300.0, 96.0  # dots per inch: of a copied picture, and for which lengths in pixels are given
INCH = 0.0254  # m
HERE = "Measure a line", "Keep as A", "Wipe A and B", "Difference of A and B", "Partner as A", "Whole record"
PYTHON = """from insonify import simulate
from insonify.scene import scene_from_toml

scene = scene_from_toml(
    r'''
{scene}'''
)
record = simulate(scene)
"""


class RecordMenu(QObject):
    """Offers what can be done with a pixel, a record and its scene."""

    def __init__(self, window: MainWindow, session: Session, inspection: Inspection) -> None:
        super().__init__(window)
        self._window, self._session, self._inspection = window, session, inspection
        tip, program = "Copy the record with its rulers, at 300 dots per inch", self._copy_program
        self.copies = [
            make_action(window, "Copy picture of the record", tip, "Ctrl+Shift+C", self._copy_picture),
            make_action(window, "Copy scene as TOML", "Copy the scene as the text of its file", "", self._copy_scene),
            make_action(window, "Copy scene as Python", "Copy a program that simulates this record", "", program),
        ]
        window.menus.group("Edit", self.copies)
        for view in (window.waterfall, window.record_a):
            view.menu_wanted.connect(lambda mark, place, view=view: self.open(view, mark, place))

    def open(self, view: WaterfallView, mark: Mark | None, place: QPoint) -> QMenu:
        """Open the menu for a pixel of a record, None beside it, at a place of the screen."""
        menu = QMenu(view)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        if mark is not None and view is self._window.waterfall:
            pinned = mark == self._inspection.mark
            explain = menu.addAction("Release this pixel" if pinned else "Explain this pixel")
            explain.triggered.connect(lambda: self._inspection.pin(mark))
        if mark is not None:
            menu.addAction("Mark a contact here").triggered.connect(lambda: self._mark(view, mark))
            menu.addSeparator()
        menu.addActions(self._named(HERE))
        menu.addSeparator()
        menu.addActions(self.copies)
        menu.popup(place)
        return menu

    def _named(self, names: Sequence[str]) -> list[QAction]:
        """Commands of the menu *Record* by their names."""
        return [action for action in self._window.menus.record.actions() if action.text() in names]

    def _mark(self, view: WaterfallView, mark: Mark) -> None:
        """Mark a contact where the menu was opened: the mouse has left that place since."""
        view.hovered.emit(mark)
        for action in self._named(["Mark a contact"]):
            action.trigger()

    def _copy_picture(self) -> None:
        """Copy the live record as it is drawn, with more pixels."""
        QGuiApplication.clipboard().setImage(draw_large(self._window.waterfall))
        self._window.say("copied the picture of the record, 300 dots per inch")

    def _copy_scene(self) -> None:
        QGuiApplication.clipboard().setText(scene_to_toml(self._session.scene))
        self._window.say("copied the scene as TOML")

    def _copy_program(self) -> None:
        QGuiApplication.clipboard().setText(PYTHON.format(scene=scene_to_toml(self._session.scene)))
        self._window.say("copied a program that simulates this record")


def draw_large(widget: QWidget) -> QImage:
    """Draw a widget into a picture of `RESOLUTION`, in which its text and lines are as large as on the screen."""
    scale = RESOLUTION / USUAL
    image = QImage(widget.size() * scale, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(scale)
    widget.render(image)
    for set_dots in (image.setDotsPerMeterX, image.setDotsPerMeterY):
        set_dots(round(RESOLUTION / INCH))
    return image
