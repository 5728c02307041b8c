"""Actions on targets in the record, and on the effects of the scene."""

from PySide6.QtCore import QEvent

from insonify_viewer.viewer import Viewer
from soak.actions import Random, Steps, action
from soak.input import LEFT, NONE, mouse, pick


@action(3.0)
def drag_handle(viewer: Viewer, random: Random) -> Steps:
    """Choose a target, and mostly drag one of its handles over the record."""
    record, targets = viewer.window.waterfall, viewer.session.scene.targets
    viewer.targets.handles.choose(int(random.integers(len(targets))) if targets else None)
    yield 30.0
    handle = pick(list(record.handles._shown), random)
    if handle is None:
        return
    place = record.handles.place(handle[0])
    x, y = float(place.x()), float(place.y())
    mouse(record, QEvent.Type.MouseMove, x, y, NONE)
    mouse(record, QEvent.Type.MouseButtonPress, x, y, LEFT)
    for across, along in random.normal(0.0, 6.0, (random.integers(1, 20), 2)):
        x, y = x + across, y + along
        mouse(record, QEvent.Type.MouseMove, x, y, LEFT)
        yield 30.0
    mouse(record, QEvent.Type.MouseButtonRelease, x, y, LEFT)
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
