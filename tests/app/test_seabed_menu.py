"""The 3-D view by its menu: places of the camera, colours of depths, and a new target in both views."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAction, QGuiApplication
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QMenu

from insonify.scene import edit
from insonify_viewer.seabed.cameras import CAMERAS

pytestmark = pytest.mark.usefixtures("drawn_seabed")


@pytest.fixture
def viewer(open_viewer, small):
    return open_viewer(edit(small, {"targets": []}))


def trigger(viewer, text):
    next(each for each in viewer.window.findChildren(QAction) if each.text() == text).trigger()


def sight(viewer):
    camera = viewer.seabed.view._canvas.plotter.camera
    return np.array(camera.position), np.array(camera.focal_point)


def test_the_camera_goes_to_its_places_and_follows_unless_told_otherwise(viewer, qtbot):
    viewer.run(False)
    seen = {}
    for camera in CAMERAS:
        trigger(viewer, camera)
        position, focus = sight(viewer)
        seen[camera] = (position - focus) / np.linalg.norm(position - focus)
    assert seen["From above"][2] > 0.99
    assert abs(seen["From abeam"][1]) > 0.9, "the track runs along x"
    before = sight(viewer)
    viewer.go_to(20)
    qtbot.waitUntil(lambda: viewer.complete)
    assert not np.allclose(sight(viewer), before)
    trigger(viewer, "Follow the towfish")
    before = sight(viewer)
    viewer.go_to(40)
    qtbot.waitUntil(lambda: viewer.complete)
    assert np.allclose(sight(viewer), before)
    viewer.window.reset_view.trigger()
    assert viewer.seabed.view.follows


def test_a_right_click_opens_the_menu_of_a_place(viewer, qtbot):
    widget = viewer.seabed.view._canvas.widget
    x, y = viewer.seabed.view.handles._in_view(np.array([15.0, 12.0, 0.0]))
    QTest.mouseClick(widget, Qt.MouseButton.RightButton, pos=QPoint(round(x), round(widget.height() - 1.0 - y)))
    (menu,) = (each for each in viewer.window.findChildren(QMenu) if each.isVisible())
    texts = [action.text() for action in menu.actions() if action.text()]
    assert texts[:2] == ["Light up the pixels that receive its echo", "Show this place in the record"]
    menu.actions()[1].trigger()
    assert viewer.session.mark is not None
    assert (viewer.session.mark.side, viewer.session.mark.ping) == (0, pytest.approx(75, abs=3))
    menu.close()


def test_depths_have_colours_with_a_bar(viewer, qtbot):
    view = viewer.seabed.view
    assert view.guides._shown[0] > 0.0
    plain = viewer.seabed._patch.image.copy()
    trigger(viewer, "Depth colours")
    qtbot.waitUntil(lambda: viewer.complete)
    shallow, deep = viewer.seabed._patch.depths
    assert 0.0 < shallow < viewer.session.scene.seabed.depth < deep
    qtbot.waitUntil(lambda: view.guides._shown[2] == (shallow, deep))
    assert (viewer.seabed._patch.image != plain).mean() > 0.5
    trigger(viewer, "Copy picture of the 3-D view")
    assert QGuiApplication.clipboard().image().width() == 3 * view._canvas.plotter.window_size[0]


def test_a_new_target_is_chosen_framed_and_in_the_record(viewer, qtbot):
    viewer.run(False)
    viewer.window.target_wanted.emit("box")
    qtbot.waitUntil(lambda: viewer.complete and bool(viewer.session.scene.targets) and not viewer.seabed.view.follows)
    handles = viewer.targets.handles
    assert handles.chosen == 0
    target = viewer.session.scene.targets[0]
    position, focus = sight(viewer)
    assert focus[:2] == pytest.approx(target.position[:2])
    assert np.linalg.norm(position - focus) < 0.5 * viewer.session.scene.sonar.range
    assert any(action == "move" for _, _, action, _ in viewer.window.waterfall.handles._shown)
