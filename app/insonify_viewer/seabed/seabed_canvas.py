"""Canvas of the three-dimensional view: an OpenGL widget or a picture in memory, and its keys."""

import time
from collections.abc import Callable
from importlib import import_module
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QSizeF, Qt
from PySide6.QtGui import (
    QContextMenuEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from insonify.arrays import Bytes
from insonify_viewer.errors import guard_override
from insonify_viewer.seabed.lean_pyvista import pv
from insonify_viewer.widgets.painting import Painted, image_of

STILL = 3  # px by which the mouse may move in a click
STEP = 5.0  # degrees that a key turns the view
CLOSER, NOTCH = 1.1, 120.0  # magnification by a key, and by a notch of the wheel; eighths of a degree of a notch
TURNS: dict[int, tuple[float, float]] = {  # degrees across and up: the scene follows the arrow, as it follows the mouse
    Qt.Key.Key_Left: (-STEP, 0.0),
    Qt.Key.Key_Right: (STEP, 0.0),
    Qt.Key.Key_Up: (0.0, STEP),
    Qt.Key.Key_Down: (0.0, -STEP),
}
ZOOMS: dict[int, float] = {Qt.Key.Key_Plus: CLOSER, Qt.Key.Key_Minus: 1.0 / CLOSER}
OF_FOCUS = Qt.Key.Key_Tab, Qt.Key.Key_Backtab


class InteractiveCanvas:
    """An OpenGL widget that the mouse turns."""

    def __init__(self, parent: QWidget) -> None:
        self.plotter: Any = import_module("pyvistaqt").QtInteractor(parent, auto_update=False, multi_samples=0)
        self.plotter.enable_terrain_style(mouse_wheel_zooms=False)
        # VTK's keys would close the view or turn on stereo; the keys belong to the window.
        for event in ("CharEvent", "KeyPressEvent", "KeyReleaseEvent"):
            self.plotter.iren.interactor.RemoveObservers(event)
        self.widget: QWidget = self.plotter

    def on_turn(self, turned: Callable[[], None]) -> None:
        """Call a function whenever the person has turned or moved the view by the mouse."""
        self.plotter.iren.interactor.GetInteractorStyle().AddObserver("InteractionEvent", lambda *_: turned())

    def on_hold(self, held: Callable[[bool], None]) -> None:
        """Call a function with True when the person takes hold of the view, and with False when it is released."""
        style = self.plotter.iren.interactor.GetInteractorStyle()
        style.AddObserver("StartInteractionEvent", lambda *_: held(True))
        style.AddObserver("EndInteractionEvent", lambda *_: held(False))

    def on_click(self, clicked: Callable[[float, float], None]) -> None:
        """Call a function with the place of a click that does not turn the view."""
        interactor = self.plotter.iren.interactor
        begun: list[tuple[int, int] | None] = [None]

        def release() -> None:
            place = interactor.GetEventPosition()
            if begun[0] is not None and abs(place[0] - begun[0][0]) + abs(place[1] - begun[0][1]) <= STILL:
                clicked(*place)

        style = interactor.GetInteractorStyle()
        style.AddObserver("StartInteractionEvent", lambda *_: begun.__setitem__(0, interactor.GetEventPosition()))
        style.AddObserver("EndInteractionEvent", lambda *_: release())
        interactor.AddObserver("RightButtonPressEvent", lambda *_: begun.__setitem__(0, None), -1.0)  # opens a menu

    def draw(self) -> None:
        """Draw soon, with the rest of the window."""
        self.widget.update()

    def draw_time(self) -> float:
        """Seconds that the last drawing took."""
        return float(self.plotter.renderer.GetLastRenderTimeInSeconds())

    def close(self) -> None:
        """Release the drawing resources."""
        self.plotter.close()
        # The plotter lives until it is collected. Its reference to a surface, which Qt deletes with the window, would
        # then point to whatever object Qt makes at the same address.
        self.plotter._cleanup_context()


class OffScreenCanvas:
    """Pictures drawn in memory, without an OpenGL widget."""

    def __init__(self, parent: QWidget) -> None:
        self.plotter: Any = pv.Plotter(off_screen=True, window_size=[640, 480])
        self.widget = _PixelsWidget(self._resize, parent)
        self._took = 0.0

    def on_turn(self, turned: Callable[[], None]) -> None:
        """Nobody turns a picture."""

    def on_hold(self, held: Callable[[bool], None]) -> None:
        """Nobody takes hold of a picture."""

    def on_click(self, clicked: Callable[[float, float], None]) -> None:
        """Call a function with the place of a click."""
        self.widget.clicked = clicked

    def _resize(self, size: QSizeF) -> None:
        self.plotter.window_size = [max(round(size.width()), 2), max(round(size.height()), 2)]
        self.draw()

    def draw(self) -> None:
        """Draw immediately."""
        start = time.perf_counter()
        self.plotter.render()
        self.widget.show_pixels(self.plotter.screenshot(return_img=True))
        self._took = time.perf_counter() - start

    def draw_time(self) -> float:
        """Seconds that the last drawing took."""
        return self._took

    def close(self) -> None:
        """Release the drawing resources."""
        self.plotter.close()


class _PixelsWidget(Painted):
    """A widget that shows an array of pixels."""

    def __init__(self, resized: Any, parent: QWidget) -> None:
        super().__init__(parent)
        self._resized = resized
        self._image = QImage()
        self.clicked: Callable[[float, float], None] = lambda x, y: None

    def show_pixels(self, pixels: Bytes) -> None:
        self._image = image_of(pixels)
        self.update()

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        self._resized(self.size().toSizeF() * self.devicePixelRatioF())  # in pixels of the screen

    def mousePressEvent(self, event: QMouseEvent) -> None:
        place = event.position()
        if event.button() is not Qt.MouseButton.LeftButton:
            return
        ratio = self.devicePixelRatioF()
        self.clicked(place.x() * ratio, (self.height() - 1.0 - place.y()) * ratio)

    def paint(self, painter: QPainter) -> None:
        painter.drawImage(self.rect(), self._image)


class SeabedInput(QObject):
    """Turns a view by keys, zooms it by wheel and keys, and passes on right clicks; a drag belongs to the view."""

    # Other keys are left to the window, where + and − zoom the record. VTK's own event of the wheel lacks the position
    # of the mouse.

    def __init__(
        self,
        widget: QWidget,
        *,
        clicked: Callable[[QPoint], None],  # by the right button, or by the key for a menu
        wheeled: Callable[[QPointF, float], None],  # the position of the mouse, and a magnification
        turned: Callable[[float, float], None],
        zoomed: Callable[[float], None],
    ) -> None:
        super().__init__(widget)
        self._widget, self._clicked, self._pressed = widget, clicked, QPoint()
        self._wheeled, self._turned, self._zoomed = wheeled, turned, zoomed
        widget.installEventFilter(self)

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Act on an event before the view does; return whether the view is not to have it."""
        if isinstance(event, QWheelEvent):
            if event.angleDelta().y() != 0:
                self._wheeled(event.position(), CLOSER ** (event.angleDelta().y() / NOTCH))
            return True
        if isinstance(event, QKeyEvent):
            return event.key() not in OF_FOCUS and self._press(event)
        if isinstance(event, QMouseEvent) and event.button() is Qt.MouseButton.RightButton:
            place = event.position().toPoint()
            if event.type() is QEvent.Type.MouseButtonPress:
                self._pressed = place
            elif event.type() is QEvent.Type.MouseButtonRelease and (place - self._pressed).manhattanLength() <= STILL:
                self._clicked(place)
        elif isinstance(event, QContextMenuEvent) and event.reason() is QContextMenuEvent.Reason.Keyboard:
            self._clicked(self._widget.rect().center())
        return False

    def _press(self, event: QKeyEvent) -> bool:
        """Act on a key of the view before the shortcuts of the window do."""
        key = event.key()  # a letter of another alphabet has no name in Qt.Key
        others = event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
        event.setAccepted(key in (*TURNS, *ZOOMS) and not others)
        if event.isAccepted() and event.type() is QEvent.Type.KeyPress:
            if key in TURNS:
                self._turned(*TURNS[key])
            else:
                self._zoomed(ZOOMS[key])
        return True
