"""The water's panel: rays of the current scene, points to drag, eigenrays on a click."""

from typing import Any

import pytest
from controls import activate, drag
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog

from insonify.scene import edit
from insonify_viewer.state.session import Session

PROFILE = {"kind": "profile", "depth": [0.0, 10.0, 20.0, 30.0], "sound_speed": [1520.0, 1518.0, 1500.0, 1502.0]}


@pytest.fixture
def layered(small):
    return edit(small, {"water": PROFILE})


def wait_for_rays(viewer, qtbot):
    qtbot.waitUntil(lambda: viewer.complete)


def colours(widget) -> int:
    """Number of colours in a picture of the widget."""
    picture = widget.grab().toImage()
    return len({picture.pixel(x, y) for x in range(0, picture.width(), 3) for y in range(0, picture.height(), 3)})


def test_the_panel_opens_with_layered_water_and_stays_out_of_the_way_without(viewer, layered, qtbot):
    assert not viewer.panels["water"].view.isVisible()
    viewer.window._buttons["water"].trigger()
    wait_for_rays(viewer, qtbot)
    assert viewer.panels["water"].complete
    assert colours(viewer.panels["water"].view) > 30, "uniform water can be looked at too"
    viewer.window._buttons["water"].trigger()
    assert not viewer.panels["water"].view.isVisible()
    viewer.session.open(layered)
    wait_for_rays(viewer, qtbot)
    assert viewer.panels["water"].view.isVisible()
    assert colours(viewer.panels["water"].view) > 100
    viewer.window._buttons["water"].trigger()
    assert not viewer.panels["water"].view.isVisible()
    viewer.session.settle({"water.depth.1": 9.0})
    assert not viewer.panels["water"].view.isVisible()


def handle(view) -> QPoint:
    """Place of the second point of the profile."""
    depth, speed = view.points[1]
    return view.scales().of_speed(speed, depth).toPoint()


def test_a_point_of_the_profile_is_dragged_the_drag_undone_and_a_click_asks_for_rays(open_viewer, layered, qtbot):
    viewer = open_viewer(layered)
    wait_for_rays(viewer, qtbot)
    view = viewer.panels["water"].view
    start = handle(view)
    drag(view, start, start + QPoint(-20, 10))
    water = viewer.session.scene.water
    assert water.sound_speed[1] < 1517.0
    assert water.depth[1] > 10.3
    assert water.depth[0::2] == (0.0, 20.0)
    wait_for_rays(viewer, qtbot)
    viewer.session.undo()
    assert viewer.session.scene == layered
    wait_for_rays(viewer, qtbot)
    assert (handle(view) - start).manhattanLength() <= 1
    view.point_dragged.emit(1, 29.0, 1800.0)
    assert viewer.session.scene.water.depth == (0.0, 19.9, 20.0, 30.0), "it never passes its neighbours"
    assert viewer.session.scene.water.sound_speed[1] == 1700.0
    view.point_dragged.emit(1, -5.0, 1000.0)
    assert viewer.session.scene.water.depth[1] == 0.1
    assert viewer.session.scene.water.sound_speed[1] == 1300.0
    # A click into the water asks for the rays to it.
    viewer.open(layered)
    wait_for_rays(viewer, qtbot)
    shown = []
    view_shown = view.show_diagram
    view.show_diagram = lambda diagram, points: (shown.append(diagram), view_shown(diagram, points))
    qtbot.mouseClick(view, Qt.MouseButton.LeftButton, pos=view.scales().at(30.0, 25.0).toPoint())
    qtbot.waitUntil(lambda: bool(shown))
    assert shown[0].target == pytest.approx((30.0, 25.0), abs=0.3)
    assert len(shown[0].eigenrays) == 1
    assert viewer.session.scene == layered


def open_with_keyboard(open_viewer, scene, qtbot, reason=Qt.FocusReason.TabFocusReason) -> tuple[Any, Any]:
    """Open a viewer, and return it and its view of the water, which has the keyboard."""
    viewer = open_viewer(scene)
    activate(viewer.window, qtbot)
    wait_for_rays(viewer, qtbot)
    view = viewer.panels["water"].view
    view.setFocus(reason)
    return viewer, view


def test_keys_choose_a_point_and_move_it_until_the_keyboard_leaves_it(open_viewer, layered, qtbot):
    viewer, view = open_with_keyboard(open_viewer, layered, qtbot)
    QTest.keyClick(view, Qt.Key.Key_Tab)
    plain = view.grab().toImage()
    QTest.keyClick(view, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is view
    assert view.grab().toImage() != plain, "the chosen point is seen"
    QTest.keyClick(view, Qt.Key.Key_Backtab)
    for _ in range(7):  # as a key that is held
        QTest.keyPress(view, Qt.Key.Key_Right)
    QTest.keyPress(view, Qt.Key.Key_Down, Qt.KeyboardModifier.ShiftModifier)
    water = viewer.session.scene.water
    assert (water.depth[1], water.sound_speed[1]) == pytest.approx((11.0, 1518.0 + 7 * 0.2))
    assert not viewer.session.history.undoable, "the key is still down"
    QTest.keyRelease(view, Qt.Key.Key_Right)
    wait_for_rays(viewer, qtbot)
    viewer.session.undo()
    assert viewer.session.scene == layered, "one step of undo"
    for _ in range(3):
        QTest.keyClick(view, Qt.Key.Key_Left)  # not one of the steps is lost while rays are traced
    assert viewer.session.scene.water.sound_speed[1] == pytest.approx(1518.0 - 3 * 0.2)
    # A point is settled when the keyboard leaves it.
    viewer.open(layered)
    wait_for_rays(viewer, qtbot)
    undoable = viewer.session.history.undoable
    QTest.keyPress(view, Qt.Key.Key_Left)
    assert viewer.session.history.undoable == undoable
    viewer.window.waterfall.setFocus()
    assert len(viewer.session.history.undoable) == len(undoable) + 1


def test_a_key_asks_for_the_rays_to_a_point_of_the_water(open_viewer, layered, qtbot):
    viewer, view = open_with_keyboard(open_viewer, layered, qtbot, Qt.FocusReason.BacktabFocusReason)
    panel = viewer.panels["water"]
    plain = view.grab().toImage()
    QTest.keyClick(view, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClick(view, Qt.Key.Key_Down)
    assert view.grab().toImage() != plain, "the cross is seen"
    assert viewer.session.scene == layered
    QTest.keyClick(view, Qt.Key.Key_Return)
    frame = view.scales()
    assert panel._target == pytest.approx((0.6 * frame.reach, 0.51 * frame.bottom))
    wait_for_rays(viewer, qtbot)
    assert view._diagram.target == pytest.approx(panel._target)
    QTest.keyClick(view, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is not view, "the cross is the last stop"


def test_a_cast_is_asked_for_and_columns_of_water_have_no_sliders(
    open_viewer, small, layered, qtbot, tmp_path, monkeypatch
):
    path = tmp_path / "cast.csv"
    path.write_text("depth,speed\n0,1520\n12,1515\n30,1500\n")
    viewer = open_viewer(small)
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: ("", ""))
    viewer.panels["parameters"].view.settled.emit("water.kind", "cast")
    assert viewer.session.scene == small
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    viewer.panels["parameters"].view.settled.emit("water.kind", "cast")
    assert viewer.session.scene.water.path == str(path)
    wait_for_rays(viewer, qtbot)
    assert viewer.panels["water"].view.isVisible()
    # Columns of water have no sliders.
    viewer.open(layered)
    for kind in ("profile", "hydrography", "section", "uniform"):
        viewer.panels["parameters"].view.settled.emit("water.kind", kind)
        assert viewer.session.scene.water.kind == kind
        viewer.panels["parameters"].view.row("water.reference_speed")
        with pytest.raises(StopIteration):
            viewer.panels["parameters"].view.row("water.depth.0")
    viewer.panels["parameters"].view.row("water.sound_speed")


def test_slower_water_lowers_the_ping_rate(small):
    session = Session(edit(small, {"water": PROFILE, "sonar.ping_rate": 15.0}))
    assert session.settle({"water.sound_speed": [1400.0] * 4})
    assert session.scene.sonar.ping_rate == 14.0
    assert session.settle({"water.sound_speed.2": 1450.0})
    assert session.scene.sonar.ping_rate == 14.0
