"""Mouse and wheel, and choices at random, for the actions."""

from collections.abc import Iterable
from typing import Any

from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication, QComboBox, QWidget

from insonify_viewer.viewer import Viewer
from soak.actions import Random, Steps

LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton


def rows(viewer: Viewer, kind: type) -> list[Any]:
    view = viewer.panels["parameters"].view
    if not view.isEnabled():
        return []
    return [row for box in view.sections.values() for row in box.rows.values() if isinstance(row, kind)]


def pick(entries: list[Any], random: Random) -> Any:
    return entries[random.integers(len(entries))] if entries else None


def choose_entry(box: QComboBox, random: Random) -> None:
    index = int(random.integers(box.count()))
    box.setCurrentIndex(index)
    box.activated.emit(index)


def mouse(widget: QWidget, kind: QEvent.Type, x: float, y: float, button: Qt.MouseButton) -> None:
    place = QPointF(x, y)
    pressed = NONE if kind is QEvent.Type.MouseMove else button
    held = NONE if kind is QEvent.Type.MouseButtonRelease else button
    everywhere = QPointF(widget.mapToGlobal(place.toPoint()))
    QApplication.sendEvent(widget, QMouseEvent(kind, place, everywhere, pressed, held, Qt.KeyboardModifier.NoModifier))


def drag(widget: QWidget, places: Iterable[Any]) -> Steps:
    """Press the left button at the first place, move over the others in steps, and release it at the last."""
    places = list(places)
    mouse(widget, QEvent.Type.MouseButtonPress, *places[0], LEFT)
    for place in places[1:]:
        mouse(widget, QEvent.Type.MouseMove, *place, LEFT)
        yield 30.0
    mouse(widget, QEvent.Type.MouseButtonRelease, *places[-1], LEFT)


def wheel(widget: QWidget, angle: int) -> None:
    place = QPointF(widget.width() / 2.0, widget.height() / 2.0)
    everywhere = QPointF(widget.mapToGlobal(place.toPoint()))
    no_key, phase = Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase
    event = QWheelEvent(place, everywhere, QPoint(), QPoint(0, angle), NONE, no_key, phase, False)
    QApplication.sendEvent(widget, event)
