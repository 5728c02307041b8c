"""Targets are picked, dragged, turned and resized in the record and in three dimensions."""

import math
from unittest.mock import Mock

import numpy as np
import pytest
from controls import drag, finish
from PySide6.QtCore import QObject, QPoint, QPointF, Qt
from PySide6.QtGui import QPainter, QPixmap
from PySide6.QtTest import QTest

from insonify.scene import edit, load_scene
from insonify.simulation import prepare
from insonify_viewer.record.marked_point import locate_mark
from insonify_viewer.record.record_handles import TIPS, RecordHandles
from insonify_viewer.seabed.handle_geometry import Handle, drag_edit, echo_mark, echo_marks, handles_of, target_at
from own_kinds import own_kinds

BOX = {"kind": "box", "position": [12.0, -20.0], "size": [4.0, 2.0, 1.5], "heading": 30.0}


@pytest.fixture
def one_box(small):
    return edit(small, {"targets": [BOX], "sonar.bins": 400})


def number_of(viewer, action: str, target: int = 0) -> int:
    handles = viewer.targets.handles.all
    return next(k for k, handle in enumerate(handles) if (handle.target, handle.action) == (target, action))


@pytest.mark.parametrize("motion", ["straight", {"kind": "yaw", "amplitude": 3.0, "period": 9.0}])
def test_a_handle_stands_where_the_echo_is(motion):
    sphere = {"kind": "sphere", "position": [30.0, -18.0], "radius": 0.3, "gap": 1.0}
    scene = edit(load_scene("default"), {"targets": [sphere], "track.motion": motion, "sonar.beam": "knife"})
    scene = edit(scene, {"seabed.relief": "flat", "seabed.material": {"diffuse": 0.001, "specular": 0.0}})
    simulation = prepare(scene)
    record = simulation.intensity(np.arange(400))
    ping, side, strongest = np.unravel_index(int(record.argmax()), record.shape)
    mark = echo_mark(simulation, handles_of(simulation, None)[0].place)
    assert mark is not None
    assert mark.side == side == 1
    # The sphere is 0.6 m long, three pings; its near face echoes up to a radius before its middle, and bins are 5 cm.
    assert abs(mark.ping - ping) <= 2
    assert 0 <= mark.bin - strongest <= 8


def test_handles_of_many_targets_are_found_as_those_of_each_and_placed_once_a_paint(qtbot):
    places = [(3.0 * k, 18.0 * (-1) ** k, 0.0) for k in range(-20, 90)] + [(30.0, 400.0, 0.0), (-500.0, 10.0, 0.0)]
    motion = {"kind": "yaw", "amplitude": 3.0, "period": 9.0}
    spheres = [{"kind": "sphere", "position": [*place[:2]], "radius": 0.3} for place in places]
    simulation = prepare(edit(load_scene("default"), {"targets": spheres, "track.motion": motion}))
    found = handles_of(simulation, 7)
    assert [handle.target for handle in found if handle.action == "move"] == list(range(len(places)))
    marks = echo_marks(simulation, [handle.place for handle in found])
    assert marks == [echo_mark(simulation, handle.place) for handle in found]
    assert marks[-2:] == [None, None]
    shown = [(k, mark, handle.action, handle.target == 7) for k, (handle, mark) in enumerate(zip(found, marks)) if mark]
    calls = []

    def places_of(bins):
        calls.append(len(bins))
        return bins[:, [2, 0]]

    parent = QObject()
    handles = RecordHandles(places_of, Mock(), parent)
    handles.show(shown)
    picture = QPixmap(200, 200)
    with QPainter(picture) as painter:
        handles.draw(painter)
    assert calls == [len(shown)]
    _, mark, action, _ = shown[0]
    assert handles.hover(QPoint(mark.bin, mark.ping)) == TIPS[action]
    assert calls == [len(shown)] * 2


EAST, NORTH = (16.0, -20.0, 0.0), (12.0, -17.0, 0.0)
ASIDE, FARTHER = (12.0, -16.0, 0.0), (12.0, -14.0, 0.0)


@pytest.mark.parametrize(
    ("target", "action", "start", "end", "edited"),
    [
        (BOX, "move", (12.0, -20.0, 0.0), (15.0, -22.5, 0.3), {"position": [15.0, -22.5]}),
        (BOX, "turn", EAST, NORTH, {"heading": 120.0}),
        (BOX, "turn", NORTH, EAST, {"heading": -60.0}),
        (BOX, "resize", EAST, (20.0, -20.0, 0.0), {"size.0": 8.0, "size.1": 4.0, "size.2": 3.0}),
        ({"kind": "pipe", "radius": 0.5, "length": 20.0}, "thicken", ASIDE, FARTHER, {"radius": 0.75}),
        ({"kind": "box", "size": [4.0, 2.0, 1.5]}, "thicken", ASIDE, FARTHER, {"size.1": 3.0, "size.2": 2.25}),
        ({"kind": "cone", "radius": 0.5, "height": 1.2}, "thicken", ASIDE, FARTHER, {"height": 1.8}),
        ({"kind": "aircraft", "plan": "dakota"}, "resize", EAST, (20.0, -20.0, 0.0), {"length": 38.86}),
    ],
)
def test_a_drag_moves_turns_resizes_or_thickens_and_keeps_the_length(target, action, start, end, edited):
    scene = edit(load_scene("default"), {"targets": [{"position": [12.0, -20.0], **target}]})
    changes = drag_edit(scene, Handle(0, action, start), start, end)
    assert changes == {f"targets.0.{name}": value for name, value in edited.items()}


def drag_handle(viewer, view, action: str, times: float = 2.0):
    """Take a handle of the only target, in the record or in the 3-D view, to so many times its way from the middle."""
    viewer.targets.handles.choose(0)
    viewer.seabed.draw_now()
    handle, centre = (QPointF(view.handles.place(number_of(viewer, each))).toPoint() for each in (action, "move"))
    in_record = view is viewer.window.waterfall
    assert not in_record or (handle - centre).manhattanLength() > 2 * 9, "each is taken by itself"
    drag(view if in_record else view.canvas.widget, handle, centre + (handle - centre) * times)


def test_targets_are_dragged_and_resized_in_the_record_and_in_three_dimensions(open_viewer, small, one_box, qtbot):
    """The handle that raises stands opposite the one that thickens; length and width stay as they are."""
    mark = echo_mark(prepare(one_box), (12.0, -20.0, 0.0))
    viewer = open_viewer(one_box, solid=True, until=lambda viewer: viewer.targets.handles.choose_at(mark) is None)
    qtbot.waitUntil(lambda: viewer.complete)
    session, view, seabed, record = viewer.session, viewer.seabed.view, viewer.seabed, viewer.window.waterfall
    assert viewer.targets.handles.chosen == 0, "it is chosen before its scene is traced"
    seabed.draw_now()
    canvas, position = view.canvas.widget, tuple(view.canvas.plotter.camera.position)
    start = view.handles.place(number_of(viewer, "move")).toPoint()
    drag(canvas, start, start + QPoint(25, 10))
    assert session.history.undoable == ("box 1 moved",)
    moved = np.hypot(*(np.array(session.scene.targets[0].position) - np.array(BOX["position"])))
    assert 0.5 < moved < 40.0
    qtbot.waitUntil(lambda: viewer.complete)
    place = view.handles.place(number_of(viewer, "move")).toPoint()
    assert (place - start - QPoint(25, 10)).manhattanLength() <= 12, "the target follows the mouse"
    assert tuple(view.canvas.plotter.camera.position) == position, "the view does not turn meanwhile"
    handle, centre, thicken = (record.handles.place(number_of(viewer, each)) for each in ("raise", "move", "thicken"))
    assert (handle - centre).x() * (thicken - centre).x() < 0
    assert "higher" in record.handles.hover(handle)
    for where, times, lowest, highest in ((record, 2.0, 2.0, 5.0), (view, 0.5, 0.0, 1.2)):
        finish(viewer, qtbot, session.undo)
        assert session.scene == one_box
        drag_handle(viewer, where, "raise", times)
        assert session.history.undoable == ("box 1 height",)
        length, width, height = session.scene.targets[0].size
        assert (length, width) == tuple(BOX["size"][:2])
        assert lowest < height < highest
    # A pipe is thickened, and a mesh resized.
    pipe = {"kind": "pipe", "position": [12.0, -20.0], "radius": 0.5, "length": 6.0, "heading": 0.0}
    scene = edit(small, {"targets": [pipe], "sonar.bins": 400})
    finish(viewer, qtbot, viewer.open, scene)
    for where, lowest, highest in ((record, 0.8, 1.4), (view, 0.6, math.inf)):
        drag_handle(viewer, where, "thicken")
        assert session.history.undoable[0] == "pipe 1 thickened"
        assert lowest < session.scene.targets[0].radius < highest
        assert session.scene.targets[0].length == 6.0
        finish(viewer, qtbot, session.undo)
        assert session.scene == scene
    mesh = {"kind": "mesh", "path": "wreck", "scale": 0.2, "position": [12.0, -20.0], "heading": 90.0}
    finish(viewer, qtbot, viewer.open, edit(small, {"targets": [mesh], "sonar.bins": 400}))
    drag_handle(viewer, view, "resize")
    assert session.history.undoable[0] == "wreck 1 resized"
    assert 0.25 < session.scene.targets[0].scale < 0.8
    session.undo()
    assert session.scene.targets[0].scale == 0.2


@pytest.mark.parametrize(
    "kind", ["box", "cone", "mesh", "pipe", "sphere", "wreck", "aircraft", "person", "hoop", "dumbbell"]
)
def test_every_kind_with_a_size_has_a_handle_for_it(kind):
    """A drag of every handle of a size changes it, and each size of a kind is changed by one of its handles.

    The one that thickens stands off the target by 5 m of a range of 50 m, to port, and never on the one that moves.
    """
    special = {"mesh": {"path": "wreck"}, "pipe": {"heading": 90.0}}
    target = {"kind": kind, "position": [12.0, -20.0]} | special.get(kind, {})
    with own_kinds():  # two of another package among them
        _check_handles(kind, edit(load_scene("default"), {"targets": [target]}))


def _check_handles(kind, scene):
    handles, changed = handles_of(prepare(scene), 0), set()
    beside = [handle.place[:2] for handle in handles if handle.action == "thicken"]
    assert bool(beside) is (kind in ("box", "cone", "pipe"))
    assert kind != "pipe" or beside[0] == pytest.approx((12.0 - 0.5 - 5.0, -20.0))
    for handle in handles:
        if handle.action in ("resize", "thicken", "raise"):
            away = tuple(2.0 * now - middle for now, middle in zip(handle.place, (12.0, -20.0, 0.0), strict=True))
            changed |= {path.split(".")[2] for path in drag_edit(scene, handle, handle.place, away)}
    sizes = {"length", "size", "radius", "height", "scale", "tube"} & set(type(scene.targets[0]).model_fields)
    assert changed == sizes


def test_a_target_is_found_by_a_place_within_it():
    scene = load_scene("default")
    assert target_at(scene, 40.0, 22.0) == 0
    along = math.radians(4.0)
    assert target_at(scene, 40.0 + 25.0 * math.cos(along), 22.0 + 25.0 * math.sin(along)) == 0, "near the pipe's end"
    assert target_at(scene, 63.9, -18.1) == 2
    assert target_at(scene, 10.0, -20.0) is None


def test_a_click_chooses_a_target_that_is_dragged_and_none_of_the_last_scene(open_viewer, small, one_box, qtbot):
    viewer = open_viewer(one_box)
    record = viewer.window.waterfall
    QTest.mouseClick(record, Qt.MouseButton.LeftButton, pos=record.handles.place(0))
    assert viewer.targets.handles.chosen == 0
    assert viewer.inspection.mark is not None
    assert viewer.session.history.undoable == ()
    finish(viewer, qtbot, viewer.open, edit(one_box, {"targets.0.locked": True}))
    assert viewer.targets.handles.all == (), "locked targets stay"
    # A handle of the last scene drags no other target.
    pipe = {"kind": "pipe", "position": [12.0, -20.0], "radius": 0.5, "length": 10.0}
    finish(viewer, qtbot, viewer.open, edit(small, {"targets": [pipe]}))
    viewer.targets.handles.choose(0)
    thicken, resize = number_of(viewer, "thicken"), number_of(viewer, "resize")
    viewer.session.open(edit(small, {"targets": [{"kind": "sphere", "position": [12.0, -20.0]}]}))
    before = viewer.session.scene
    for number in (thicken, resize):  # of the pipe: the sphere is not traced yet
        viewer.seabed.taken.emit(number)
        for x in (3.0, 4.0):
            viewer.seabed.pulled.emit((x, -20.0, 0.0))
        viewer.seabed.released.emit()
    assert viewer.session.scene == before
    # A click into an echo chooses its target, which is turned, resized and dragged.
    finish(viewer, qtbot, viewer.open, one_box)
    handles = viewer.targets.handles
    assert handles.chosen is None, "of another scene"
    assert [handle.action for handle in handles.all] == ["move"]
    beside = record.handles.place(0) + QPoint(10, 0)
    QTest.mouseClick(record, Qt.MouseButton.LeftButton, pos=beside)
    assert handles.chosen == 0
    assert [handle.action for handle in handles.all] == ["move", "turn", "resize", "thicken", "raise"]
    turn = record.handles.place(number_of(viewer, "turn"))
    centre = record.handles.place(number_of(viewer, "move"))
    drag(record, turn, turn + QPoint(0, 2 * (centre.y() - turn.y())))
    assert viewer.session.history.undoable[0] == "box 1 turned"
    assert viewer.session.scene.targets[0].heading == pytest.approx(150.0, abs=12.0)  # mirrored at the line athwart
    qtbot.waitUntil(lambda: viewer.complete)
    drag_handle(viewer, record, "resize")
    assert viewer.session.history.undoable[0] == "box 1 resized"
    assert viewer.session.scene.targets[0].size[0] > 5.5
    QTest.mouseClick(record, Qt.MouseButton.LeftButton, pos=record.handles.place(0) + QPoint(-120, 60))
    assert handles.chosen is None
    # A target is dragged.
    finish(viewer, qtbot, viewer.open, one_box)
    session, before = viewer.session, viewer.session.history.undoable
    start = record.handles.place(number_of(viewer, "move"))
    near, far = start, start + QPoint(30, -25)
    begin, end = (locate_mark(viewer.answer.simulation, record.mark_at(place))[2] for place in (near, far))
    drag(record, near, far)
    moved = np.array(session.scene.targets[0].position) - np.array(BOX["position"])
    np.testing.assert_allclose(moved, np.array(end[:2]) - np.array(begin[:2]), atol=2e-3)
    assert session.history.undoable == ("box 1 moved", *before)
    qtbot.waitUntil(lambda: viewer.complete)
    place = record.handles.place(number_of(viewer, "move"))
    assert (place - far).manhattanLength() <= 4, "the handle stays under the mouse"
    session.undo()
    assert session.scene == one_box
