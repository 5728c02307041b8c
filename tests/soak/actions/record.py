"""Actions on the record: display options, measuring, contacts, recordings beside it, targets and effects."""

import numpy as np
from PySide6.QtCore import QEvent

from insonify_viewer.state.inspection import Mark
from insonify_viewer.viewer import Viewer
from insonify_viewer.widgets.field_rows import STEPS
from soak.actions import Random, Steps, action
from soak.input import NONE, choose_entry, drag, mouse, pick, wheel


@action(2.0)
def change_display(viewer: Viewer, random: Random) -> Steps:
    """Change a few display options, and now and then put them back."""
    viewer.window.open_panel("record")
    view = viewer.panels["record"].view
    for _ in range(random.integers(1, 4)):
        choose_entry(pick([row.combo for row in view.choices.values() if row.combo.isEnabled()], random), random)
        yield float(random.choice([30.0, 300.0]))
    gain = pick(view.gains, random)
    gain.slider.setValue(int(random.integers(STEPS)))
    yield 50.0
    low, high = sorted(random.uniform(-50.0, 20.0, 2))
    view.histogram.ends_dragged.emit(float(low), float(high) + 1.0)
    view.zoomed.emit(float(random.choice([0.0, 0.5, 2.0])))
    yield 100.0
    if random.random() < 0.5:
        view.usual.click()
        yield 50.0


@action(1.0)
def measure_distance(viewer: Viewer, random: Random) -> Steps:
    """Measure by a drag over the record."""
    view, record = viewer.panels["record"].view, viewer.window.waterfall
    view.measure.click()
    yield from drag(record, random.random((6, 2)) * [record.width(), record.height()])
    if view.measure.isChecked():
        view.measure.click()
    yield 30.0


@action(1.5)
def keep_contacts(viewer: Viewer, random: Random) -> Steps:
    """Mark contacts, name, show and remove them, and write or read them."""
    viewer.window.open_panel("record")
    listed, scene = viewer.panels["record"].view.contacts, viewer.session.scene
    for _ in range(random.integers(1, 5)):
        mark = Mark(viewer.window.waterfall.top, int(random.integers(2)), int(random.integers(scene.sonar.bins)))
        viewer.inspection.pin(mark)
        yield 50.0
        listed.mark.click()
        yield 30.0
    if not listed.list.rowCount():
        return
    row = int(random.integers(listed.list.rowCount()))
    listed.choose(row)
    listed.edited.emit(row, "name", "wreck?")
    listed.jump_wanted.emit(row)
    yield 200.0
    pick([listed.save, listed.open, listed.remove], random).click()
    yield 100.0


@action(1.0)
def look_at_recording(viewer: Viewer, random: Random) -> Steps:
    """Open a recording, look along it while it is read or played, and mostly close it again."""
    viewer.window.open_recording.trigger()
    yield float(random.choice([20.0, 1500.0]))
    for _ in range(random.integers(0, 6)):
        viewer.recordings.look_back(int(random.integers(-40, 40)))
        wheel(viewer.window.waterfall, int(random.choice([-120, 120])))
        yield 100.0
    if random.random() < 0.7:
        viewer.recordings.close()
        yield 50.0


@action(3.0)
def drag_handle(viewer: Viewer, random: Random) -> Steps:
    """Choose a target, and mostly drag one of its handles over the record."""
    record, targets = viewer.window.waterfall, viewer.session.scene.targets
    viewer.targets.handles.choose(int(random.integers(len(targets))) if targets else None)
    yield 30.0
    handle = pick(list(record.handles.shown), random)
    if handle is None:
        return
    place = record.handles.place(handle[0]).toTuple()
    mouse(record, QEvent.Type.MouseMove, *place, NONE)
    moves = random.normal(0.0, 6.0, (random.integers(1, 20), 2))
    yield from drag(record, [place, *(place + np.cumsum(moves, axis=0))])
    yield 100.0


@action(2.0)
def tick_effect(viewer: Viewer, random: Random) -> Steps:
    """Take an effect out, and mostly bring it back."""
    view = viewer.panels["parameters"].view
    tick = pick([tick for tick in view.effects.ticks.values() if tick.isEnabled()], random)
    if tick is None or not view.isEnabled():
        return
    tick.click()
    yield float(random.choice([30.0, 500.0]))
    if random.random() < 0.7 and tick.isEnabled():
        tick.click()
        yield 100.0
