"""The panel of the sonar equation: terms at the range under the cursor, curves over range, sentences."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest

from insonify.explanation.sonar_equation import solve_sonar_equation
from insonify.scene import edit, load_scene
from insonify_viewer.panels.budget.levels import COMPARED, signed
from insonify_viewer.record.marked_point import MarkedPoint
from insonify_viewer.state.inspection import Mark


@pytest.fixture
def scene():
    return edit(load_scene("raw-record"), {"track.pings": 32, "seabed.relief": "flat", "targets": []})


@pytest.fixture
def viewer(open_viewer, scene, qtbot):
    opened = open_viewer(scene, prepare=None)
    assert opened.panels["budget"]._solved is None, "a closed panel solves nothing"
    opened.window.open_panel("budget")
    wait(opened, qtbot)
    return opened


def wait(viewer, qtbot):
    qtbot.waitUntil(lambda: viewer.panels["budget"].complete, timeout=240000)


def groups(viewer):
    return {group.name: group for group in viewer.panels["budget"].view.terms.groups}


def test_it_lists_the_terms_of_the_sonar_equation_at_half_the_range_and_at_the_cursor(viewer, scene, qtbot):
    solved, _ = solve_sonar_equation(scene)
    k = scene.sonar.bins // 2
    found = groups(viewer)
    assert found["bed"].level == pytest.approx(solved.bed.decibels[k])
    assert dict(found["bed"].rows) == pytest.approx({name: float(term[k]) for name, term in solved.bed.terms.items()})
    for level in (solved.target, *solved.disturbances):
        assert found[level.name].level == pytest.approx(level.decibels[k])
    over = dict(found[COMPARED].rows)["bed over noise"]
    assert over == pytest.approx(solved.bed.decibels[k] - solved.disturbance[k])
    text = viewer.panels["budget"].view.terms.toPlainText()
    assert signed(solved.bed.decibels[k]) in text
    assert "the target is above it up to" in viewer.panels["budget"].view.sentence.text()
    assert "Medium sand: " in viewer.panels["budget"].view.model.text()
    # The cursor in the record and in the curves chooses the range.
    panel = viewer.panels["budget"]
    panel.point_marked(MarkedPoint(Mark(0, 0, 800), 40.0, None, None, 1.0))
    assert groups(viewer)["bed"].level == pytest.approx(solved.bed.decibels[800])
    assert "At 40.0 m the bed stands" in panel.view.sentence.text()
    curves, area = panel.view.curves, panel.view.curves.area
    place = QPoint(round(area.left() + 0.5 * area.width()), round(area.center().y()))
    QTest.mouseMove(curves, place)
    qtbot.waitUntil(lambda: "At 40.0 m" not in panel.view.sentence.text())
    share = (place.x() - area.left()) / area.width()
    assert f"At {share * scene.sonar.range:.1f} m" in panel.view.sentence.text()
    before = panel._range
    QTest.keyClick(curves, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    assert panel._range == pytest.approx(before + 0.1 * scene.sonar.range)
    QTest.keyClick(curves, Qt.Key.Key_Left)
    assert panel._range == pytest.approx(before + 0.09 * scene.sonar.range)
    # The curves are painted.
    image = curves.grab().toImage()
    colours = {image.pixelColor(x, y).name() for x in range(image.width()) for y in range(0, image.height(), 2)}
    assert len(colours) > 12
    curves.show_levels(None)
    plain = curves.grab().toImage()
    assert np.unique([plain.pixel(x, 20) for x in range(plain.width())]).size == 1


def test_it_follows_the_scene_and_the_target_and_has_no_levels_of_light(viewer, scene, qtbot):
    before = groups(viewer)
    viewer.panels["budget"].view._target.setValue(-5.0)
    wait(viewer, qtbot)
    assert groups(viewer)["target"].level == pytest.approx(before["target"].level + 15.0)
    viewer.session.settle({"receiver.source_level": 200.0})
    wait(viewer, qtbot)
    assert groups(viewer)["bed"].level == pytest.approx(before["bed"].level + 10.0)
    viewer.session.settle({"receiver.noise": "none", "receiver.reverberation": "none"})
    wait(viewer, qtbot)
    assert "the scene has no noise" in viewer.panels["budget"].view.sentence.text()
    assert "noise" not in groups(viewer)
    # The law of light has no levels.
    viewer.session.settle({"sonar.law": "light"})
    wait(viewer, qtbot)
    view = viewer.panels["budget"].view
    assert "no sonar equation" in view.sentence.text()
    assert view.terms.groups == ()
    view.curves.grab()
