"""Actions in the window itself: scenes, sliders, targets, the record, the 3-D view, plan, charts and files."""

from collections.abc import Callable
from typing import Any

import numpy as np
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QTabBar
from shiboken6 import isValid

from insonify.scene import bundled_scenes
from insonify_viewer.viewer import Viewer
from insonify_viewer.widgets.field_rows import STEPS, ChoiceRow, NumberRow
from insonify_viewer.window.target_placement import target_menu
from soak.actions import Random, Steps, action
from soak.input import LEFT, NONE, choose_entry, drag, mouse, pick, rows, wheel

SCENES = [str(path) for path in bundled_scenes().values()]


def give(weight: float, name: str, step: Callable[[Any, Random], Any], waits: list[float], most: int = 1) -> None:
    """Register an action: a step in the window, up to so many at once, with a wait after each."""

    def do(viewer: Viewer, random: Random) -> Steps:
        for _ in range(random.integers(1, most + 1)):
            step(viewer.window, random)
            yield float(random.choice(waits))

    do.__name__ = name
    action(weight)(do)


give(3.0, "open_bundled", lambda window, random: window.scenes.wanted.emit(pick(SCENES, random)), [20.0, 500.0, 3000.0])
give(2.0, "open_file", lambda window, random: pick([window.open_scene, window.open_dem], random).trigger(), [300.0])
give(
    3.0, "undo_and_redo", lambda window, random: pick([window.undo, window.undo, window.redo], random).trigger(),
    [5.0, 100.0], most=7,
)  # fmt: skip
give(3.0, "pause_or_play", lambda window, _: window.pause.trigger(), [50.0, 2000.0])
give(0.7, "open_rays", lambda window, _: window.buttons["water"].trigger(), [100.0, 2000.0])
give(
    0.7, "save",
    lambda window, random: pick([window.save.scene, window.save.record, window.save.picture], random).trigger(),
    [200.0],
)  # fmt: skip
give(2.0, "add_target", lambda window, random: window.target_wanted.emit(pick(list(target_menu()), random)), [300.0])
give(
    1.0, "look_back", lambda window, random: wheel(window.waterfall, int(random.choice([-120, 120, 30]))), [20.0],
    most=7,
)  # fmt: skip
give(1.0, "change_speed", lambda window, random: choose_entry(window.speed, random), [200.0])
give(1.0, "change_palette", lambda window, random: choose_entry(window.palettes, random), [30.0])
give(0.5, "resize", lambda window, random: window.resize(*random.integers((760, 420), (1500, 950)).tolist()), [200.0])
give(3.0, "rest", lambda *_: None, [10.0, 500.0, 2500.0])


@action(8.0)
def drag_slider(viewer: Viewer, random: Random) -> Steps:
    row = pick(rows(viewer, NumberRow), random)
    if row is None or not row.slider.isEnabled() or row.slider.isHidden():
        return
    slider = row.slider
    slider.setSliderDown(True)
    for position in np.cumsum(random.normal(0.0, 40.0, random.integers(3, 40))) + slider.value():
        if not isValid(slider):  # the row has vanished with the edit
            return
        slider.setValue(int(min(max(position, 0), STEPS)))
        yield 16.0
    if isValid(slider):
        slider.setSliderDown(False)


@action(2.0)
def type_value(viewer: Viewer, random: Random) -> Steps:
    row = pick(rows(viewer, NumberRow), random)
    if row is None or not row.field.isEnabled():
        return
    row.field.setFocus()
    row.field.setText(str(random.choice(["1", "0", "-1", "3.5", "20 cm", "500 kHz", "x", "", "nan", "1e9", "7"])))
    row.field.setModified(True)
    row.field.returnPressed.emit()
    row.field.editingFinished.emit()
    yield 50.0


@action(3.0)
def choose(viewer: Viewer, random: Random) -> Steps:
    row = pick(rows(viewer, ChoiceRow), random)
    if row is not None and row.combo.isEnabled():
        choose_entry(row.combo, random)
        yield 200.0


@action(1.0)
def fold(viewer: Viewer, random: Random) -> Steps:
    box = pick(list(viewer.panels["parameters"].view.sections.values()), random)
    if box is not None:
        box.unfold(not box.unfolded)
        yield 30.0


@action(1.0)
def remove_target(viewer: Viewer, random: Random) -> Steps:
    view = viewer.panels["parameters"].view
    key = pick([key for key, box in view.sections.items() if box.removable], random)
    if key is not None:
        view.removed.emit(key)
        yield 50.0


@action(2.0)
def edit_back_and_forth(viewer: Viewer, random: Random) -> Steps:
    """Edit, take it back and do it again: nothing of it may be lost."""
    session = viewer.session
    if session.settle():  # a drag that another action left is an edit of its own
        yield 20.0
    before = session.scene
    if session.settle({"track.altitude": float(random.uniform(3.0, 15.0))}):
        after = session.scene
        for step, expected in ((session.undo, before), (session.redo, after)):
            step()
            assert session.scene == expected, f"{step.__name__} lost an edit"
    yield 50.0


@action(1.0)
def change_gain(viewer: Viewer, random: Random) -> Steps:
    for value in random.integers(-300, 300, 8):
        viewer.window.gain.setValue(int(value))
        yield 16.0
    viewer.window.levels.trigger()


@action(2.0)
def hover(viewer: Viewer, random: Random) -> Steps:
    record = viewer.window.waterfall
    for x, y in random.random((12, 2)):
        mouse(record, QEvent.Type.MouseMove, x * record.width(), y * record.height(), NONE)
        yield 16.0


@action(2.0)
def scrub(viewer: Viewer, random: Random) -> Steps:
    record = viewer.window.waterfall
    x, y = record.handle.place_of(record.top).toTuple()
    yield from drag(record, [(x, y), *((x, part * record.height()) for part in random.random(random.integers(2, 15)))])


@action(2.0)
def explain_pixel(viewer: Viewer, random: Random) -> Steps:
    record = viewer.window.waterfall
    for x, y in random.random((random.integers(1, 4), 2)):
        for kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonRelease):
            mouse(record, kind, x * record.width(), y * record.height(), LEFT)
        yield float(random.choice([20.0, 400.0]))
    if random.random() < 0.3:
        viewer.window.trace.trigger()


@action(1.0)
def pick_place(viewer: Viewer, random: Random) -> Steps:
    view = viewer.seabed.view
    if view is not None:
        view.look_at(*(random.random(2) * [view.width(), view.height()]))
        yield float(random.choice([20.0, 400.0]))


@action(3.0)
def turn_view(viewer: Viewer, random: Random) -> Steps:
    view = viewer.seabed.view
    if view is None:
        return
    canvas, middle = view.canvas.widget, np.array([view.width(), view.height()]) / 2.0
    moves = random.normal(0.0, 12.0, (random.integers(2, 25), 2))
    yield from drag(canvas, [middle, *(middle + np.cumsum(moves, axis=0))])
    for _ in range(random.integers(0, 6)):
        wheel(canvas, int(random.choice([-120, 120])))
        yield 30.0
    if random.random() < 0.3:
        viewer.window.reset_view.trigger()


@action(1.5)
def turn_tab(viewer: Viewer, random: Random) -> Steps:
    bar = pick([bar for bar in viewer.window.findChildren(QTabBar) if bar.count() and bar.isVisible()], random)
    if bar is not None:
        bar.setCurrentIndex(int(random.integers(bar.count())))
        yield 100.0


@action(0.7)
def force_choice(viewer: Viewer, random: Random) -> Steps:
    view = viewer.panels["plan"].view
    kind = random.integers(4)
    if kind == 0:
        view.automatic.click()
    elif kind == 1:
        view.tolerated.emit(float(random.choice([0.01, 0.03, 0.1])))
    else:
        view.forced.emit("planes", [str(random.choice([1, 4, 8])), None][kind - 2])
    yield 500.0


@action(0.3)
def measure_chart(viewer: Viewer, random: Random) -> Steps:
    viewer.window.open_panel("chart")
    chart = viewer.panels["chart"].view
    yield 200.0
    chart.measure.click()
    yield float(random.choice([100.0, 4000.0, 12000.0]))
    chart.stop.click()
    yield 100.0
    chart.close()
