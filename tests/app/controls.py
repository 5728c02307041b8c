"""Controls of a window, as the person and assistive technology meet them, and scenes that have all of them."""

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QMimeData, QObject, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QAccessible, QAction, QDragEnterEvent, QDropEvent, QImage, QMouseEvent, QWheelEvent
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QHeaderView,
    QLabel,
    QLineEdit,
    QMessageBox,
    QScrollBar,
    QTabBar,
    QWidget,
)

from insonify.scene import bundled_scenes, load_scene
from insonify_viewer.record.record_canvas import RecordCanvas
from insonify_viewer.state.sections import sections_of
from insonify_viewer.viewer import Viewer
from insonify_viewer.window.main_window import MainWindow

CONTROLS = (QAbstractSlider, QAbstractSpinBox, QLineEdit, QComboBox, QAbstractButton, QAbstractItemView)
WHOLE = (QComboBox, QAbstractSpinBox, QLineEdit, QAbstractItemView)  # what is inside belongs to them


def controls_of(window: QWidget) -> list[QWidget]:
    """Every slider, field, combo box, tick, button and list below a widget, without their own parts."""
    found = [child for child in window.findChildren(QWidget) if isinstance(child, CONTROLS) and not _is_part(child)]
    return [child for child in found if not isinstance(child, (QScrollBar, QHeaderView))]


def picture_of(view: RecordCanvas) -> NDArray[np.uint32]:
    """Colours of the rows of a record on screen, newest first, as 0xffRRGGBB."""
    rows = view.record.rows(view.record.shown(view.top))
    return np.asarray(view.image.pixels[view.image._places(rows)])


def colours_of(image: QImage) -> NDArray[np.uint32]:
    """Colours of the pixels of an image, as 0xRRGGBB by row and column."""
    plain = image.convertToFormat(QImage.Format.Format_RGB32)
    words = np.frombuffer(plain.constBits(), np.uint32).reshape(plain.height(), plain.width())
    return words & 0xFFFFFF  # a copy, which outlives the image


def focusable(window: QWidget) -> set[QWidget]:
    """Widgets below one that can have the keyboard, without parts of another one and texts without words."""
    found = (child for child in window.findChildren(QWidget) if child.focusPolicy() != Qt.FocusPolicy.NoFocus)
    return {child for child in found if not (_is_part(child) or (isinstance(child, QLabel) and not child.text()))}


def _is_part(widget: QWidget) -> bool:
    """Whether a widget belongs to another one, on which a person acts instead."""
    named = widget.objectName().startswith(("qt_", "ScrollLeft", "ScrollRight"))
    return named or any(isinstance(parent, WHOLE) for parent in _parents(widget))


def activate(window: QWidget, qtbot: Any) -> None:
    """Give a window the keyboard, also where no window manager does."""
    window.windowHandle().requestActivate()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)


def assert_side_by_side(window: QWidget, *parts: QWidget) -> None:
    """Check that parts of a window lie within its width, none of them over another."""
    places = [part.rect().translated(part.mapTo(window, QPoint(0, 0))) for part in parts]
    for one, place in enumerate(places):
        assert 0 <= place.left() <= place.right() < window.width()
        assert not any(place.intersects(other) for other in places[:one])


@contextmanager
def watched_events(
    application: QApplication, kind: QEvent.Type, which: Callable[[QObject], bool] = lambda _: True
) -> Iterator[list[QObject]]:
    """List the objects to which events of a kind come meanwhile, once for each event, and which are so just then."""
    objects: list[QObject] = []

    class Watch(QObject):
        def eventFilter(self, watched: QObject, event: QEvent) -> bool:
            if event.type() is kind and which(watched):
                objects.append(watched)
            return False

    watch = Watch()
    application.installEventFilter(watch)
    try:
        yield objects
    finally:
        application.removeEventFilter(watch)


def bring_to_front(window: MainWindow, panel: str) -> None:
    """Show the panel of a tab at the side."""
    for bar in window.findChildren(QTabBar):
        for index in range(bar.count()):
            if bar.tabText(index) == window.panels[panel].title:
                bar.setCurrentIndex(index)


def drop(window: QWidget, *paths: object) -> None:
    """Drop files on a window as a file manager does."""
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    rest = (Qt.DropAction.CopyAction, data, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier)
    for event in (QDragEnterEvent(QPoint(400, 300), *rest), QDropEvent(QPointF(400, 300), *rest)):
        event.ignore()
        QApplication.sendEvent(window, event)
        assert event.isAccepted()


def answer_questions(monkeypatch: pytest.MonkeyPatch, *answers: QMessageBox.StandardButton) -> list[str]:
    """Answer questions in turn, all later ones as the last; the list that is returned holds the questions."""
    asked, left = [], list(answers)

    def answer(_: Any, __: str, question: str, *rest: Any) -> QMessageBox.StandardButton:
        asked.append(question)
        return left.pop(0) if len(left) > 1 else left[0]

    monkeypatch.setattr(QMessageBox, "question", answer)
    return asked


def finish(viewer: Viewer, qtbot: Any, act: Callable[..., Any], *given: Any) -> None:
    """Do something with a viewer, and wait until its record is complete."""
    act(*given)
    qtbot.waitUntil(lambda: viewer.complete, timeout=240_000)  # ms, while kernels compile at worst


def drag(view: QWidget, first: QPoint, last: QPoint) -> None:
    """Drag with the left button in small steps."""
    QTest.mouseMove(view, first)
    QTest.mousePress(view, Qt.MouseButton.LeftButton, pos=first)
    for step in range(1, 9):
        move_mouse(view, first + (last - first) * step / 8, Qt.MouseButton.LeftButton)
    QTest.mouseRelease(view, Qt.MouseButton.LeftButton, pos=last)


def move_mouse(view: QWidget, place: QPoint, buttons: Qt.MouseButton = Qt.MouseButton.NoButton) -> None:
    """Move the mouse to a place of a widget, wherever the pointer of the screen is."""
    event = QMouseEvent(
        QEvent.Type.MouseMove, QPointF(place), QPointF(view.mapToGlobal(place)), Qt.MouseButton.NoButton, buttons,
        Qt.KeyboardModifier.NoModifier,
    )  # fmt: skip
    QApplication.sendEvent(view, event)


def move_slider(slider: QAbstractSlider, *positions: int) -> QAbstractSlider:
    """Take hold of a slider and move it, without letting go of it."""
    slider.setSliderDown(True)
    for position in positions:
        slider.setValue(position)
    return slider


def choose(combo: QComboBox, entry: int | str) -> None:
    """Choose an entry of a list, by its number or its text, as the person does."""
    combo.setCurrentIndex(combo.findText(entry) if isinstance(entry, str) else entry)
    combo.activated.emit(combo.currentIndex())


def press_shortcut(window: MainWindow, key: str) -> None:
    """Trigger the one action of a window with a key; a window that no manager activates gets no shortcuts."""
    known = {*window.findChildren(QAction), *window.actions()}
    (action,) = (each for each in known if each.shortcut().toString().lower() == key.lower())
    assert action in window.actions(), "the window itself holds the action, so that it works everywhere"
    action.trigger()


def accessible_name(widget: QWidget) -> str:
    """Name of a widget, as a screen reader says it."""
    return QAccessible.queryAccessibleInterface(widget).text(QAccessible.Text.Name).strip()


def place_of(widget: QWidget) -> str:
    """Class, name and texts of a widget, by which a person finds it."""
    text = widget.text() if isinstance(widget, (QAbstractButton, QLineEdit)) else ""
    parents = "/".join(type(parent).__name__ for parent in _parents(widget)[:4])
    return f"{type(widget).__name__} {widget.objectName()!r} {text!r} {widget.toolTip()[:30]!r} in {parents}"


def _parents(widget: QWidget) -> list[QWidget]:
    """Widgets in which a widget is, the nearest first."""
    parent = widget.parentWidget()
    return [] if parent is None else [parent, *_parents(parent)]


def turn_wheel(
    view: QWidget, place: QPoint, notches: int, keys: Qt.KeyboardModifier = Qt.KeyboardModifier.NoModifier
) -> None:
    """Turn the wheel over a place of a widget, away from the hand if notches are above 0."""
    event = QWheelEvent(
        QPointF(place), QPointF(view.mapToGlobal(place)), QPoint(), QPoint(0, 120 * notches), Qt.MouseButton.NoButton,
        keys, Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(view, event)


def scenes_by_rows() -> list:
    """Every bundled scene as a case; slow are those whose rows, by path and label, all stand in scenes before them."""
    cases, known = [], set()
    for name in sorted(bundled_scenes()):
        rows = [row for section in sections_of(load_scene(name)) for row in section.parameters]
        kinds = {re.sub(r"\d+", "0", f"{row.path} {row.label}") for row in rows}
        cases.append(pytest.param(name, marks=[pytest.mark.slow] * (kinds <= known)))
        known |= kinds
    return cases
