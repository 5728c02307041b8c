"""What a person does in the window, drawn at random: each action yields the milliseconds until its next step."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication, QComboBox, QTabBar, QWidget

from insonify.scene import bundled_scenes
from insonify_viewer.target_placement import target_menu
from insonify_viewer.viewer import Viewer
from insonify_viewer.views.field_rows import STEPS, ChoiceRow, NumberRow

Random = np.random.Generator
Steps = Iterator[float]
LEFT, NONE = Qt.MouseButton.LeftButton, Qt.MouseButton.NoButton


class Action(NamedTuple):
    """An action, and how often it is taken beside the others."""

    do: Callable[[Viewer, Random], Steps]
    weight: float


def open_bundled(viewer: Viewer, random: Random) -> Steps:
    paths = list(bundled_scenes().values())
    viewer.window.scenes.wanted.emit(str(paths[random.integers(len(paths))]))
    yield float(random.choice([20.0, 500.0, 3000.0]))


def open_file(viewer: Viewer, random: Random) -> Steps:
    window = viewer.window
    (window.open_scene if random.random() < 0.6 else window.open_dem).trigger()
    yield 300.0


def drag_slider(viewer: Viewer, random: Random) -> Steps:
    row = _pick(_rows(viewer, NumberRow), random)
    if row is None or not row.slider.isEnabled() or row.slider.isHidden():
        return
    slider = row.slider
    slider.setSliderDown(True)
    for position in np.cumsum(random.normal(0.0, 40.0, random.integers(3, 40))) + slider.value():
        slider.setValue(int(min(max(position, 0), STEPS)))
        yield 16.0
    slider.setSliderDown(False)


def type_value(viewer: Viewer, random: Random) -> Steps:
    row = _pick(_rows(viewer, NumberRow), random)
    if row is None or not row.field.isEnabled():
        return
    row.field.setFocus()
    row.field.setText(str(random.choice(["1", "0", "-1", "3.5", "20 cm", "500 kHz", "x", "", "nan", "1e9", "7"])))
    row.field.setModified(True)
    row.field.returnPressed.emit()
    row.field.editingFinished.emit()
    yield 50.0


def choose(viewer: Viewer, random: Random) -> Steps:
    row = _pick(_rows(viewer, ChoiceRow), random)
    if row is not None and row.combo.isEnabled():
        index = int(random.integers(row.combo.count()))
        row.combo.setCurrentIndex(index)
        row.combo.activated.emit(index)
        yield 200.0


def fold(viewer: Viewer, random: Random) -> Steps:
    box = _pick(list(viewer.panels["parameters"].view._sections.values()), random)
    if box is not None:
        box.unfold(not box.unfolded)
        yield 30.0


def add_target(viewer: Viewer, random: Random) -> Steps:
    viewer.window.target_wanted.emit(_pick(list(target_menu()), random))
    yield 300.0


def remove_target(viewer: Viewer, random: Random) -> Steps:
    view = viewer.panels["parameters"].view
    key = _pick([key for key, box in view._sections.items() if box.removable], random)
    if key is not None:
        view.removed.emit(key)
        yield 50.0


def undo_and_redo(viewer: Viewer, random: Random) -> Steps:
    for _ in range(random.integers(1, 8)):
        (viewer.window.undo if random.random() < 0.6 else viewer.window.redo).trigger()
        yield float(random.choice([5.0, 100.0]))


def pause_or_play(viewer: Viewer, random: Random) -> Steps:
    viewer.window.pause.trigger()
    yield float(random.choice([50.0, 2000.0]))


def _choose_entry(box: QComboBox, random: Random) -> None:
    index = int(random.integers(box.count()))
    box.setCurrentIndex(index)
    box.activated.emit(index)


def change_speed(viewer: Viewer, random: Random) -> Steps:
    _choose_entry(viewer.window.speed, random)
    yield 200.0


def change_palette(viewer: Viewer, random: Random) -> Steps:
    _choose_entry(viewer.window.palettes, random)
    yield 30.0


def change_gain(viewer: Viewer, random: Random) -> Steps:
    for value in random.integers(-300, 300, 8):
        viewer.window.gain.setValue(int(value))
        yield 16.0
    viewer.window.levels.trigger()


def hover(viewer: Viewer, random: Random) -> Steps:
    record = viewer.window.waterfall
    for x, y in random.random((12, 2)):
        _mouse(record, QEvent.Type.MouseMove, x * record.width(), y * record.height(), NONE)
        yield 16.0


def scrub(viewer: Viewer, random: Random) -> Steps:
    record = viewer.window.waterfall
    place = record._handle.place_of(record.top)
    _mouse(record, QEvent.Type.MouseButtonPress, place.x(), place.y(), LEFT)
    for y in random.random(random.integers(2, 15)):
        _mouse(record, QEvent.Type.MouseMove, place.x(), y * record.height(), LEFT)
        yield 30.0
    _mouse(record, QEvent.Type.MouseButtonRelease, place.x(), place.y(), LEFT)


def explain_pixel(viewer: Viewer, random: Random) -> Steps:
    record = viewer.window.waterfall
    for x, y in random.random((random.integers(1, 4), 2)):
        for kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonRelease):
            _mouse(record, kind, x * record.width(), y * record.height(), LEFT)
        yield float(random.choice([20.0, 400.0]))
    if random.random() < 0.3:
        viewer.window.trace.trigger()


def pick_place(viewer: Viewer, random: Random) -> Steps:
    view = viewer.seabed.view
    if view is not None:
        view.look_at(*(random.random(2) * [view.width(), view.height()]))
        yield float(random.choice([20.0, 400.0]))


def look_back(viewer: Viewer, random: Random) -> Steps:
    for _ in range(random.integers(1, 8)):
        _wheel(viewer.window.waterfall, int(random.choice([-120, 120, 30])))
        yield 20.0


def turn_view(viewer: Viewer, random: Random) -> Steps:
    view = viewer.seabed.view
    if view is None:
        return
    canvas, place = view._canvas.widget, np.array([view.width(), view.height()]) / 2.0
    _mouse(canvas, QEvent.Type.MouseButtonPress, *place, LEFT)
    for move in random.normal(0.0, 12.0, (random.integers(2, 25), 2)):
        place = place + move
        _mouse(canvas, QEvent.Type.MouseMove, *place, LEFT)
        yield 30.0
    _mouse(canvas, QEvent.Type.MouseButtonRelease, *place, LEFT)
    for _ in range(random.integers(0, 6)):
        _wheel(canvas, int(random.choice([-120, 120])))
        yield 30.0
    if random.random() < 0.3:
        viewer.window.reset_view.trigger()


def turn_tab(viewer: Viewer, random: Random) -> Steps:
    bar = _pick([bar for bar in viewer.window.findChildren(QTabBar) if bar.count() and bar.isVisible()], random)
    if bar is not None:
        bar.setCurrentIndex(int(random.integers(bar.count())))
        yield 100.0


def open_rays(viewer: Viewer, random: Random) -> Steps:
    action = viewer.window._buttons["water"]
    action.trigger()
    yield float(random.choice([100.0, 2000.0]))


def force_choice(viewer: Viewer, random: Random) -> Steps:
    view = viewer.panels["plan"].view
    kind = random.integers(4)
    if kind == 0:
        view.left_to_plan.emit()
    elif kind == 1:
        view.tolerated.emit(float(random.choice([0.01, 0.03, 0.1])))
    else:
        view.forced.emit("planes", [str(random.choice([1, 4, 8])), None][kind - 2])
    yield 500.0


def measure_chart(viewer: Viewer, random: Random) -> Steps:
    viewer.window.open_panel("chart")
    chart = viewer.panels["chart"].widget
    yield 200.0
    chart.measure_wanted.emit()
    yield float(random.choice([100.0, 4000.0, 12000.0]))
    chart.stop_wanted.emit()
    yield 100.0
    chart.close()


def save(viewer: Viewer, random: Random) -> Steps:
    menu = viewer.window.save
    _pick([menu.scene, menu.record, menu.picture], random).trigger()
    yield 200.0


def resize(viewer: Viewer, random: Random) -> Steps:
    viewer.window.resize(int(random.integers(760, 1500)), int(random.integers(420, 950)))
    yield 200.0


def rest(viewer: Viewer, random: Random) -> Steps:
    yield float(random.choice([10.0, 500.0, 2500.0]))


ACTIONS = (
    Action(open_bundled, 3.0),
    Action(open_file, 2.0),
    Action(drag_slider, 8.0),
    Action(type_value, 2.0),
    Action(choose, 3.0),
    Action(fold, 1.0),
    Action(add_target, 2.0),
    Action(remove_target, 1.0),
    Action(undo_and_redo, 3.0),
    Action(pause_or_play, 3.0),
    Action(change_speed, 1.0),
    Action(change_palette, 1.0),
    Action(change_gain, 1.0),
    Action(hover, 2.0),
    Action(scrub, 2.0),
    Action(explain_pixel, 2.0),
    Action(pick_place, 1.0),
    Action(look_back, 1.0),
    Action(turn_view, 3.0),
    Action(turn_tab, 1.5),
    Action(open_rays, 0.7),
    Action(force_choice, 0.7),
    Action(measure_chart, 0.3),
    Action(save, 0.7),
    Action(resize, 0.5),
    Action(rest, 3.0),
)


def draw_action(random: Random) -> Action:
    weights = np.array([action.weight for action in ACTIONS])
    return ACTIONS[random.choice(len(ACTIONS), p=weights / weights.sum())]


def _rows(viewer: Viewer, kind: type) -> list[Any]:
    view = viewer.panels["parameters"].view
    if not view.isEnabled():
        return []
    return [row for box in view._sections.values() for row in box.rows.values() if isinstance(row, kind)]


def _pick(entries: list[Any], random: Random) -> Any:
    return entries[random.integers(len(entries))] if entries else None


def _mouse(widget: QWidget, kind: QEvent.Type, x: float, y: float, button: Qt.MouseButton) -> None:
    place = QPointF(x, y)
    pressed = NONE if kind is QEvent.Type.MouseMove else button
    held = NONE if kind is QEvent.Type.MouseButtonRelease else button
    everywhere = QPointF(widget.mapToGlobal(place.toPoint()))
    QApplication.sendEvent(widget, QMouseEvent(kind, place, everywhere, pressed, held, Qt.KeyboardModifier.NoModifier))


def _wheel(widget: QWidget, angle: int) -> None:
    place = QPointF(widget.width() / 2.0, widget.height() / 2.0)
    everywhere = QPointF(widget.mapToGlobal(place.toPoint()))
    no_key, phase = Qt.KeyboardModifier.NoModifier, Qt.ScrollPhase.NoScrollPhase
    event = QWheelEvent(place, everywhere, QPoint(), QPoint(0, angle), NONE, no_key, phase, False)
    QApplication.sendEvent(widget, event)
