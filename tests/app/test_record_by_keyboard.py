"""The record is looked back along, pointed at, explained, marked and wiped by keys alone."""

import pytest
from controls import activate, move_mouse
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.record.comparison.comparison_overlay import WIPE
from insonify_viewer.record.projection import Zoom
from insonify_viewer.state.inspection import Mark, mark_of

Key, Modifier = Qt.Key, Qt.KeyboardModifier


@pytest.fixture
def viewer(open_viewer, small, qtbot):
    """A viewer that is paused at ping 500, whose record has the keyboard."""
    opened = open_viewer(small)
    activate(opened.window, qtbot)
    opened.tow.restart(500)
    opened.run(False)
    opened.window.waterfall.show_last(500)
    qtbot.waitUntil(lambda: opened.complete)
    opened.window.waterfall.setFocus()
    return opened


def press(viewer, key: Key, modifier: Modifier = Modifier.NoModifier) -> Mark | None:
    """Press a key in the record; return what is pointed at."""
    assert QApplication.focusWidget() is viewer.window.waterfall
    QTest.keyClick(viewer.window.waterfall, key, modifier)
    mark: Mark | None = viewer.session.mark
    return mark


def point(viewer, mark: Mark):
    """Move the mouse over a bin."""
    move_mouse(viewer.window.waterfall, viewer.window.waterfall.place_of(mark))
    assert viewer.session.mark == mark


def test_keys_look_back_in_the_direction_of_the_wheel_and_every_ping_comes_under_the_cursor(viewer):
    for newest_on_top in (True, False):
        viewer.session.show(newest_on_top=newest_on_top)
        check_keys(viewer, newest_on_top)
    # Every ping comes under the cursor.
    viewer.session.show(newest_on_top=True)
    marks = [press(viewer, Key.Key_Up) for _ in range(100)]
    assert viewer.window.waterfall.top == 500, "the record goes no farther; the cursor does"
    assert marks[0] is not None
    pings = [mark.ping for mark in marks if mark is not None]
    assert pings == [min(pings[0] + k, 500) for k in range(100)]
    press(viewer, Key.Key_End, Modifier.ControlModifier)
    marks = [press(viewer, Key.Key_Down) for _ in range(150)]
    pings = [mark.ping for mark in marks if mark is not None]
    assert pings == list(range(pings[0], -1, -1)), "back to the first ping"
    viewer.run(True)
    press(viewer, Key.Key_Down)
    assert "pause the tow" in viewer.window.status.sentence.text(), "a tow that runs says how to look back"


def check_keys(viewer, newest_on_top):
    back, on = (Key.Key_Down, Key.Key_Up) if newest_on_top else (Key.Key_Up, Key.Key_Down)
    pages = (Key.Key_PageDown, Key.Key_PageUp) if newest_on_top else (Key.Key_PageUp, Key.Key_PageDown)
    ends = (Key.Key_End, Key.Key_Home) if newest_on_top else (Key.Key_Home, Key.Key_End)
    tops = []
    for key in (back, back, on, *pages):
        press(viewer, key)
        tops.append(viewer.window.waterfall.top)
    assert tops == [499, 498, 499, 371, 499]
    press(viewer, back, Modifier.ShiftModifier)
    assert viewer.window.waterfall.top == 489
    press(viewer, ends[0], Modifier.ControlModifier)
    assert viewer.window.waterfall.top == 127, "the first page"
    press(viewer, ends[1], Modifier.ControlModifier)
    assert viewer.window.waterfall.top == 500


def test_arrows_go_from_bin_to_bin_along_the_row_of_a_whole_and_a_zoomed_record(viewer):
    point(viewer, Mark(450, 0, 3))
    marks = [press(viewer, Key.Key_Right) for _ in range(8)]
    assert marks == [Mark(450, 0, near) for near in (2, 1, 0)] + [Mark(450, 1, far) for far in range(5)]
    assert press(viewer, Key.Key_Left) == Mark(450, 1, 3)
    assert press(viewer, Key.Key_Right, Modifier.ShiftModifier) == Mark(450, 1, 13)
    for _ in range(120):
        mark = press(viewer, Key.Key_Right)
    assert mark == Mark(450, 1, 99), "at the edge of the record"
    assert viewer.window.waterfall._marks.cross == mark
    # It stays at its bin when the record is zoomed.
    view = viewer.window.waterfall
    point(viewer, Mark(440, 1, 3))
    QTest.keyClick(view, "+")
    assert not view.projection.zoom.whole
    assert press(viewer, Key.Key_Right) == Mark(440, 1, 4)
    edge = view.projection.zoom.right
    for expected in range(5, 95):
        assert press(viewer, Key.Key_Right) == Mark(440, 1, expected)
    assert view.projection.zoom.right > edge, "the record moves under a cursor at the edge"
    QTest.keyClick(view, "-")
    assert view.projection.zoom.whole
    point(viewer, Mark(470, 1, 40))
    before = view.place_of(Mark(470, 1, 40))
    press(viewer, Key.Key_Plus)
    assert view._zoom != Zoom()
    assert (view.place_of(Mark(470, 1, 40)) - before).manhattanLength() <= 4
    press(viewer, Key.Key_0)
    assert view.projection.zoom.whole


def test_a_pixel_at_the_cursor_that_tab_shows_is_pinned_marked_and_measured_from(viewer, qtbot):
    view = viewer.window.waterfall
    viewer.session.point_at(None)
    QTest.keyClick(view, Key.Key_Tab)
    QTest.keyClick(QApplication.focusWidget(), Key.Key_Backtab)
    assert QApplication.focusWidget() is view
    assert viewer.session.mark == view.mark_at(view.plot_area.center())
    point(viewer, Mark(450, 1, 60))
    mark = press(viewer, Key.Key_Right)
    press(viewer, Key.Key_Return)
    assert viewer.inspection.mark == mark == Mark(450, 1, 61)
    assert viewer.window.waterfall._marks.pin == mark
    assert viewer.panels["pixel"].view.isVisible(), "it is explained"
    assert QApplication.focusWidget() is viewer.window.waterfall
    press(viewer, Key.Key_Enter, Modifier.KeypadModifier)
    assert viewer.inspection.mark is None, "once more lets it go"
    # C marks a contact.
    point(viewer, Mark(450, 1, 60))
    press(viewer, Key.Key_Left)
    press(viewer, Key.Key_C)
    (contact,) = viewer.panels["record"].contacts.all
    assert mark_of(contact) == Mark(450, 1, 59)
    # Return begins and ends a measured line.
    lines = []
    view.measured.connect(lambda first, last: lines.append((first, last)))
    point(viewer, Mark(450, 1, 60))
    press(viewer, Key.Key_M)
    assert "Return" in viewer.window.status.sentence.text()
    press(viewer, Key.Key_Right)
    assert not lines, "no line has begun"
    words = viewer.panels["record"].view.measured
    unmeasured = words.text()
    press(viewer, Key.Key_Return)
    assert viewer.inspection.mark is None
    press(viewer, Key.Key_Right, Modifier.ShiftModifier)
    assert lines[-1] == (Mark(450, 1, 61), Mark(450, 1, 71))
    assert words.text() != unmeasured
    press(viewer, Key.Key_Return)
    count = len(lines)
    press(viewer, Key.Key_Left)
    assert len(lines) == count, "the line has ended"
    press(viewer, Key.Key_Return)
    press(viewer, Key.Key_M)
    press(viewer, Key.Key_Return)
    assert viewer.inspection.mark == Mark(450, 1, 70), "without measuring a pixel is explained"


def test_keys_move_the_wipe_line(viewer, qtbot):
    window, view, overlay = viewer.window, viewer.window.waterfall, viewer.window.overlay
    press(viewer, Key.Key_K)
    viewer.session.settle({"seabed.material.diffuse": 0.4})
    qtbot.waitUntil(lambda: viewer.complete)
    viewer.comparison.arrange(Arrangement.WIPED)
    split, plot = overlay.split, view.plot_area
    press(viewer, Key.Key_Right, Modifier.AltModifier)
    assert overlay.split - split == pytest.approx(WIPE * plot.width(), abs=1.0)
    for _ in range(100):
        press(viewer, Key.Key_Left, Modifier.AltModifier)
    assert overlay.split == plot.left()
    assert press(viewer, Key.Key_Left) is not None, "all of it is B"
    for _ in range(100):
        press(viewer, Key.Key_Right, Modifier.AltModifier)
    hovered = []
    window.record_a.hovered.connect(hovered.append)
    assert press(viewer, Key.Key_Left) is None, "all of it is A"
    assert hovered[-1] is not None
    press(viewer, Key.Key_Return)
    assert viewer.inspection.mark is None, "a pixel of A is not one of B"
    viewer.comparison.arrange(Arrangement.BESIDE)
    split = overlay.split
    press(viewer, Key.Key_Left, Modifier.AltModifier)
    assert overlay.split == split


def test_a_kept_record_beside_the_live_one_has_a_cursor(viewer, qtbot):
    press(viewer, Key.Key_K)
    viewer.comparison.arrange(Arrangement.BESIDE)
    view = viewer.window.record_a
    qtbot.waitUntil(view.isVisible)
    view.setFocus()
    QTest.keyClick(view, Key.Key_Right)
    cross = view._marks.cross
    assert cross is not None
    QTest.keyClick(view, Key.Key_Right)
    assert view._marks.cross == Mark(cross.ping, 1, cross.bin + 1)
    assert view.accessibleName().startswith("Record A ")
    QTest.keyClick(view, Key.Key_C)
    (contact,) = viewer.panels["record"].contacts.all
    assert mark_of(contact) == view._marks.cross
