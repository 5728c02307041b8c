"""The panels of the water and of the sonar equation: rays, points to drag, eigenrays, terms and curves over range."""

import numpy as np
import pytest
from controls import activate, colours_of, drag, finish, move_mouse
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog

from insonify.explanation.sonar_equation import solve_sonar_equation
from insonify.scene import edit, load_scene
from insonify_viewer.panels.budget.levels import COMPARED, signed
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.state.inspection import Mark

PROFILE = {"kind": "profile", "depth": [0.0, 10.0, 20.0, 30.0], "sound_speed": [1520.0, 1518.0, 1500.0, 1502.0]}


def colours(widget) -> int:
    """Number of colours in a picture of the widget."""
    return np.unique(colours_of(widget.grab().toImage())[::3, ::3]).size


def test_the_panel_opens_with_layered_water_which_may_be_a_cast(open_viewer, small, qtbot, tmp_path, monkeypatch):
    viewer, layered = open_viewer(small), edit(small, {"water": PROFILE})
    assert not viewer.panels["water"].view.isVisible()
    finish(viewer, qtbot, viewer.window.buttons["water"].trigger)
    assert viewer.panels["water"].complete
    assert colours(viewer.panels["water"].view) > 30, "uniform water can be looked at too"
    viewer.window.buttons["water"].trigger()
    assert not viewer.panels["water"].view.isVisible()
    finish(viewer, qtbot, viewer.session.open, layered)
    assert viewer.panels["water"].view.isVisible()
    assert colours(viewer.panels["water"].view) > 100
    viewer.window.buttons["water"].trigger()
    assert not viewer.panels["water"].view.isVisible()
    viewer.session.settle({"water.depth.1": 9.0})
    assert not viewer.panels["water"].view.isVisible()
    # A cast is asked for.
    finish(viewer, qtbot, viewer.open, small)
    path = tmp_path / "cast.csv"
    path.write_text("depth,speed\n0,1520\n12,1515\n13,0\n30,1500\n")
    settled = viewer.panels["parameters"].view.settled
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: ("", ""))
    settled.emit("water.kind", "cast")
    assert viewer.session.scene == small
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    finish(viewer, qtbot, settled.emit, "water.kind", "cast")
    assert viewer.session.scene.water.path == str(path)
    assert viewer.panels["water"].view.isVisible()
    assert "1 of 4 rows are left out: 1 with an impossible sound" in viewer.panels["water"].view.rays.diagram.limits[0]
    # Columns of water have no sliders.
    viewer.open(layered)
    for kind in ("profile", "hydrography", "section", "uniform"):
        settled.emit("water.kind", kind)
        assert viewer.session.scene.water.kind == kind
        viewer.panels["parameters"].view.row("water.reference_speed")
        with pytest.raises(StopIteration):
            viewer.panels["parameters"].view.row("water.depth.0")
    viewer.panels["parameters"].view.row("water.sound_speed")
    # Slower water lowers the ping rate.
    viewer.open(edit(layered, {"sonar.ping_rate": 15.0}))
    for slower in ({"water.sound_speed": [1400.0] * 4}, {"water.sound_speed.2": 1450.0}):
        assert viewer.session.settle(slower)
        assert viewer.session.scene.sonar.ping_rate == 14.0


def handle(view) -> QPoint:
    """Place of the second point of the profile."""
    depth, speed = view.profile.points[1]
    return view.profile.place_of(speed, depth)


def picture_of(plot):
    """Picture of a plot as it is now."""
    plot.draw_now()
    return plot.grab().toImage()


def test_keys_and_the_mouse_choose_a_point_move_it_until_they_leave_it_and_ask_for_rays(open_viewer, small, qtbot):
    layered = edit(small, {"water": PROFILE})
    viewer = open_viewer(layered)
    panel, view = viewer.panels["water"], viewer.panels["water"].view
    profile, rays = view.profile, view.rays
    activate(viewer.window, qtbot)
    qtbot.waitUntil(lambda: viewer.complete)
    profile.setFocus(Qt.FocusReason.TabFocusReason)
    QTest.keyClick(profile, Qt.Key.Key_Tab)
    plain = picture_of(profile)
    QTest.keyClick(profile, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is profile
    assert picture_of(profile) != plain, "the chosen point is seen"
    QTest.keyClick(profile, Qt.Key.Key_Backtab)
    for _ in range(7):  # as a key that is held
        QTest.keyPress(profile, Qt.Key.Key_Right)
    QTest.keyPress(profile, Qt.Key.Key_Down, Qt.KeyboardModifier.ShiftModifier)
    water = viewer.session.scene.water
    assert (water.depth[1], water.sound_speed[1]) == pytest.approx((11.0, 1518.0 + 7 * 0.2))
    assert not viewer.session.history.undoable, "the key is still down"
    finish(viewer, qtbot, QTest.keyRelease, profile, Qt.Key.Key_Right)
    viewer.session.undo()
    assert viewer.session.scene == layered, "one step of undo"
    for _ in range(3):
        QTest.keyClick(profile, Qt.Key.Key_Left)  # not one of the steps is lost while rays are traced
    assert viewer.session.scene.water.sound_speed[1] == pytest.approx(1518.0 - 3 * 0.2)
    # A point is settled when the keyboard leaves it.
    finish(viewer, qtbot, viewer.open, layered)
    undoable = viewer.session.history.undoable
    QTest.keyPress(profile, Qt.Key.Key_Left)
    assert viewer.session.history.undoable == undoable
    viewer.window.waterfall.setFocus()
    assert len(viewer.session.history.undoable) == len(undoable) + 1
    # A key asks for the rays to a point of the water.
    finish(viewer, qtbot, viewer.session.undo)
    assert viewer.session.scene == layered
    rays.setFocus(Qt.FocusReason.BacktabFocusReason)
    plain = picture_of(rays)
    QTest.keyClick(rays, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    QTest.keyClick(rays, Qt.Key.Key_Down)
    assert picture_of(rays) != plain, "the cross is seen"
    assert viewer.session.scene == layered
    QTest.keyClick(rays, Qt.Key.Key_Return)
    assert panel.target == pytest.approx((0.6 * rays.diagram.reach, 0.51 * rays.diagram.bottom))
    qtbot.waitUntil(lambda: viewer.complete)
    assert rays.diagram.target == pytest.approx(panel.target)
    QTest.keyClick(rays, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is not rays, "the cross is the last stop"
    # A point is dragged, and the drag undone.
    start = handle(view)
    drag(profile.surface, start, start + QPoint(-20, 10))
    water = viewer.session.scene.water
    assert water.sound_speed[1] < 1517.0
    assert water.depth[1] > 10.3
    assert water.depth[0::2] == (0.0, 20.0)
    qtbot.waitUntil(lambda: viewer.complete)
    finish(viewer, qtbot, viewer.session.undo)
    assert viewer.session.scene == layered
    assert (handle(view) - start).manhattanLength() <= 1
    for dragged, kept in (((29.0, 1800.0), (19.9, 1700.0)), ((-5.0, 1000.0), (0.1, 1300.0))):
        view.point_dragged.emit(1, *dragged)
        water = viewer.session.scene.water
        assert (water.depth[0::2], water.depth[3]) == ((0.0, 20.0), 30.0), "it never passes its neighbours"
        assert (water.depth[1], water.sound_speed[1]) == kept
    # A click into the water asks for the rays to it.
    finish(viewer, qtbot, viewer.open, layered)
    shown = []
    view_shown = view.show_diagram
    view.show_diagram = lambda diagram: (shown.append(diagram), view_shown(diagram))
    qtbot.mouseClick(rays.surface, Qt.MouseButton.LeftButton, pos=rays.place_of(30.0, 25.0))
    qtbot.waitUntil(lambda: bool(shown))
    assert shown[0].target == pytest.approx((30.0, 25.0), abs=0.3)
    assert len(shown[0].eigenrays) == 1
    assert viewer.session.scene == layered


def groups(viewer):
    return {group.name: group for group in viewer.panels["budget"].view.terms.groups}


def test_terms_of_the_sonar_equation_are_those_at_half_the_range_or_the_cursor_and_follow_the_scene(open_viewer, qtbot):
    scene = edit(load_scene("raw-record"), {"track.pings": 32, "seabed.relief": "flat", "targets": []})
    viewer = open_viewer(scene, prepare=None)
    (solved, _), k, panel = solve_sonar_equation(scene), scene.sonar.bins // 2, viewer.panels["budget"]
    assert panel.solved is None, "a closed panel solves nothing"
    finish(viewer, qtbot, viewer.window.open_panel, "budget")
    found = groups(viewer)
    assert found["bed"].level == pytest.approx(solved.bed.decibels[k])
    assert dict(found["bed"].rows) == pytest.approx({name: float(term[k]) for name, term in solved.bed.terms.items()})
    for level in (solved.target, *solved.disturbances):
        assert found[level.name].level == pytest.approx(level.decibels[k])
    over = dict(found[COMPARED].rows)["bed over noise"]
    assert over == pytest.approx(solved.bed.decibels[k] - solved.disturbance[k])
    assert signed(solved.bed.decibels[k]) in panel.view.terms.toPlainText()
    assert "the target is above it up to" in panel.view.sentence.text()
    assert "Medium sand: " in panel.view.model.text()
    # The cursor in the record and in the curves chooses the range.
    panel.point_marked(MarkedPoint(Mark(0, 0, 800), 40.0, None, None, 1.0))
    assert groups(viewer)["bed"].level == pytest.approx(solved.bed.decibels[800])
    assert "At 40.0 m the bed stands" in panel.view.sentence.text()
    curves = panel.view.curves
    curves.draw_now()
    move_mouse(curves.surface, curves.area.center())
    ranges = curves.canvas.at(QPointF(curves.area.center()))[0]
    assert ranges == pytest.approx(0.5 * scene.sonar.range, rel=0.01)
    assert f"At {ranges:.1f} m" in panel.view.sentence.text()
    before = panel.range
    QTest.keyClick(curves, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    assert panel.range == pytest.approx(before + 0.1 * scene.sonar.range)
    QTest.keyClick(curves, Qt.Key.Key_Left)
    assert panel.range == pytest.approx(before + 0.09 * scene.sonar.range)
    # The curves are painted.
    assert np.unique(colours_of(picture_of(curves))[::2]).size > 12
    assert len(curves.canvas.listDataItems()) >= 3
    curves.show_levels(None)
    curves.draw_now()
    assert not curves.canvas.listDataItems()
    # It follows the scene and the target, and has no levels of light.
    before = groups(viewer)
    finish(viewer, qtbot, panel.view.target.setValue, -5.0)
    assert groups(viewer)["target"].level == pytest.approx(before["target"].level + 15.0)
    finish(viewer, qtbot, viewer.session.settle, {"receiver.source_level": 200.0})
    assert groups(viewer)["bed"].level == pytest.approx(before["bed"].level + 10.0)
    finish(viewer, qtbot, viewer.session.settle, {"receiver.noise": "none", "receiver.reverberation": "none"})
    assert "the scene has no noise" in panel.view.sentence.text()
    assert "noise" not in groups(viewer)
    # The law of light has no levels.
    finish(viewer, qtbot, viewer.session.settle, {"sonar.law": "light"})
    assert "no sonar equation" in panel.view.sentence.text()
    assert panel.view.terms.groups == ()
    curves.grab()
