"""The three-dimensional view is turned and zoomed by keys as by the mouse; all other keys are those of the window."""

import math

import numpy as np
import pytest
from controls import activate, drag
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QWidget

from insonify_viewer.application import has_opengl
from insonify_viewer.seabed.seabed_canvas import CLOSER, STEP
from insonify_viewer.seabed.seabed_view import FARTHEST, LOWEST, NEAREST, STEEPEST

pytestmark = pytest.mark.usefixtures("drawn_seabed")


@pytest.fixture
def viewer(open_viewer, small, qtbot):
    """A viewer whose view of the seabed has the keyboard."""
    opened = open_viewer(small)
    if not has_opengl():
        pytest.skip("no OpenGL for a widget")
    activate(opened.window, qtbot)
    widget_of(opened).setMaximumSize(320, 240)  # a small picture is drawn in less time
    widget_of(opened).setFocus()
    return opened


def widget_of(viewer) -> QWidget:
    widget: QWidget = viewer.seabed.view._canvas.widget
    return widget


def away(viewer) -> np.ndarray:
    """From the focus of the camera to the camera."""
    camera = viewer.seabed.view._canvas.plotter.camera
    return np.array(camera.position) - np.array(camera.focal_point)


def angles(viewer) -> np.ndarray:
    """Bearing and slope from the focus to the camera, in degrees."""
    x, y, z = away(viewer)
    return np.degrees([math.atan2(y, x), math.atan2(z, math.hypot(x, y))])


def turned_by(viewer, key: Qt.Key) -> np.ndarray:
    before = angles(viewer)
    QTest.keyClick(widget_of(viewer), key)
    turn: np.ndarray = (angles(viewer) - before + 180.0) % 360.0 - 180.0
    return turn


def test_an_arrow_turns_the_scene_as_a_drag_does_and_neither_over_nor_below_the_bed(viewer):
    for key, way in (
        (Qt.Key.Key_Left, QPoint(-30, 0)),
        (Qt.Key.Key_Right, QPoint(30, 0)),
        (Qt.Key.Key_Up, QPoint(0, -30)),
        (Qt.Key.Key_Down, QPoint(0, 30)),
    ):
        distance, turn = np.linalg.norm(away(viewer)), turned_by(viewer, key)
        assert np.abs(turn).max() == pytest.approx(STEP)
        assert np.abs(turn).min() == pytest.approx(0.0, abs=1e-9)
        assert np.linalg.norm(away(viewer)) == pytest.approx(distance)
        widget, before = widget_of(viewer), angles(viewer)
        middle = widget.rect().center()
        drag(widget, middle, middle + way)
        dragged = (angles(viewer) - before + 180.0) % 360.0 - 180.0
        assert np.argmax(np.abs(dragged)) == np.argmax(np.abs(turn))
        assert np.sign(dragged[np.argmax(np.abs(turn))]) == np.sign(turn[np.argmax(np.abs(turn))])
    # The view neither turns over nor below the bed.
    for _ in range(40):
        QTest.keyClick(widget_of(viewer), Qt.Key.Key_Down)
    assert angles(viewer)[1] == pytest.approx(math.degrees(STEEPEST))
    for _ in range(40):
        QTest.keyClick(widget_of(viewer), Qt.Key.Key_Up)
    assert angles(viewer)[1] == pytest.approx(math.degrees(math.atan(LOWEST)), abs=0.01)


def test_plus_and_minus_zoom_within_the_limits_of_the_wheel(viewer):
    for letter, factor, limit in (("+", 1.0 / CLOSER, NEAREST), ("-", CLOSER, FARTHEST)):
        widget_of(viewer).setFocus()
        check_zoom(viewer, letter, factor, limit)


def check_zoom(viewer, letter, factor, limit):
    widget, zoom = widget_of(viewer), viewer.window.waterfall.projection.zoom
    before = np.linalg.norm(away(viewer))
    QTest.keyClick(widget, letter)
    assert np.linalg.norm(away(viewer)) == pytest.approx(factor * before)
    for _ in range(60):
        QTest.keyClick(widget, letter)
    assert np.linalg.norm(away(viewer)) == pytest.approx(limit * viewer.seabed.view._reach)
    assert viewer.window.waterfall.projection.zoom == zoom, "they zoom what has the keyboard"
    viewer.window.waterfall.setFocus()
    QTest.keyClick(viewer.window.waterfall, letter)
    assert np.linalg.norm(away(viewer)) == pytest.approx(limit * viewer.seabed.view._reach)


def test_all_other_keys_are_those_of_the_window(viewer, qtbot):
    widget, home = widget_of(viewer), away(viewer)
    QTest.keyClick(widget, Qt.Key.Key_Right)
    assert away(viewer) != pytest.approx(home)
    QTest.keyClick(widget, Qt.Key.Key_Home)
    assert away(viewer) == pytest.approx(home)
    QTest.keyClick(widget, "b")
    assert viewer.session.display.bottom_line
    QTest.keyClick(widget, Qt.Key.Key_Right, Qt.KeyboardModifier.AltModifier)
    assert away(viewer) == pytest.approx(home), "keys with Alt or Ctrl are not those of the view"
    viewer.window.tour.begin()
    widget.setFocus()
    QTest.keyClick(widget, Qt.Key.Key_Escape)
    assert viewer.window.tour.card is None
    QTest.keyClick(widget, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is not widget
    QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Backtab)
    assert QApplication.focusWidget() is widget
