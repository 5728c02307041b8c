"""The record is looked back along, pointed at, explained, marked and wiped by mouse and keys; the readout follows."""

import numpy as np
import pytest
from controls import activate, finish, move_mouse, picture_of
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.record.comparison.comparison_overlay import WIPE
from insonify_viewer.record.projection import Zoom
from insonify_viewer.record.record_image import EMPTY
from insonify_viewer.state.inspection import Mark, mark_of

Key, Modifier = Qt.Key, Qt.KeyboardModifier


@pytest.fixture
def viewer(open_viewer, small):
    return open_viewer(small)  # with the cursor where it is at first


@pytest.fixture
def focused(viewer, qtbot):
    """A viewer that is paused at ping 500, whose record has the keyboard."""
    activate(viewer.window, qtbot)
    viewer.tow.restart(500)
    viewer.run(False)
    finish(viewer, qtbot, viewer.window.waterfall.show_last, 500)
    viewer.window.waterfall.setFocus()
    return viewer


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


@pytest.mark.usefixtures("focused")
def test_keys_look_back_in_the_direction_of_the_wheel_and_bring_every_ping_and_bin_under_the_cursor(viewer):
    for newest_on_top in (True, False):
        viewer.session.show(newest_on_top=newest_on_top)
        back, on = (Key.Key_Down, Key.Key_Up) if newest_on_top else (Key.Key_Up, Key.Key_Down)
        pages = (Key.Key_PageDown, Key.Key_PageUp) if newest_on_top else (Key.Key_PageUp, Key.Key_PageDown)
        first, last = (Key.Key_End, Key.Key_Home) if newest_on_top else (Key.Key_Home, Key.Key_End)
        none, shift, control = Modifier.NoModifier, Modifier.ShiftModifier, Modifier.ControlModifier
        tops = []
        for key, held in (
            *((key, none) for key in (back, back, on, *pages)), (back, shift), (first, control), (last, control)
        ):  # fmt: skip
            press(viewer, key, held)
            tops.append(viewer.window.waterfall.top)
        assert tops == [499, 498, 499, 371, 499, 489, 127, 500], "127 is that of the first page"
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
    # Arrows go from bin to bin along the row.
    viewer.run(False)
    press(viewer, Key.Key_Home, Modifier.ControlModifier)
    point(viewer, Mark(450, 0, 3))
    marks = [press(viewer, Key.Key_Right) for _ in range(8)]
    assert marks == [Mark(450, 0, near) for near in (2, 1, 0)] + [Mark(450, 1, far) for far in range(5)]
    assert press(viewer, Key.Key_Left) == Mark(450, 1, 3)
    assert press(viewer, Key.Key_Right, Modifier.ShiftModifier) == Mark(450, 1, 13)
    for _ in range(120):
        mark = press(viewer, Key.Key_Right)
    assert mark == Mark(450, 1, 99), "at the edge of the record"
    assert viewer.window.waterfall.marks.cross == mark
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
    assert view.zoom != Zoom()
    assert (view.place_of(Mark(470, 1, 40)) - before).manhattanLength() <= 4
    press(viewer, Key.Key_0)
    assert view.projection.zoom.whole


@pytest.mark.usefixtures("focused")
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
    assert viewer.window.waterfall.marks.pin == mark
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


@pytest.mark.usefixtures("focused")
def test_keys_move_the_wipe_line_and_the_cursor_of_a_kept_record_beside_the_live_one(viewer, qtbot):
    window, view, overlay = viewer.window, viewer.window.waterfall, viewer.window.overlay
    press(viewer, Key.Key_K)
    finish(viewer, qtbot, viewer.session.settle, {"seabed.material.diffuse": 0.4})
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
    # A kept record beside the live one has a cursor.
    view = window.record_a
    qtbot.waitUntil(view.isVisible)
    view.setFocus()
    QTest.keyClick(view, Key.Key_Right)
    cross = view.marks.cross
    assert cross is not None
    QTest.keyClick(view, Key.Key_Right)
    assert view.marks.cross == Mark(cross.ping, 1, cross.bin + 1)
    assert view.accessibleName().startswith("Record A ")
    QTest.keyClick(view, Key.Key_C)
    (contact,) = viewer.panels["record"].contacts.all
    assert mark_of(contact) == view.marks.cross


def test_the_button_the_wheel_and_the_handle_go_along_the_tow_and_sentences_go(viewer, qtbot):
    window = viewer.window
    assert (window.pause.text(), window.pause.isChecked()) == ("Play", True)
    window.pause.trigger()
    assert (window.pause.text(), window.pause.isChecked()) == ("Pause", False)
    assert "Space" in window.pause.toolTip()
    # The handle brings the fish abeam of the pipe.
    waterfall, handle = viewer.window.waterfall, viewer.window.waterfall.handle
    viewer.run(True)
    qtbot.waitUntil(lambda: handle.last == 127 or viewer.tow.newest > 127)
    QTest.mousePress(waterfall, Qt.MouseButton.LeftButton, pos=handle.place_of(waterfall.top).toPoint())
    assert handle.held
    assert not viewer.tow.running
    place = handle.place_of(60)  # the pipe begins 12 m along the track
    QTest.mouseMove(waterfall, place.toPoint())
    QTest.mouseRelease(waterfall, Qt.MouseButton.LeftButton, pos=place.toPoint())
    assert not handle.held
    assert waterfall.top == pytest.approx(60, abs=1)
    qtbot.waitUntil(lambda: viewer.complete)
    assert viewer.seabed.view.fish_actor.user_matrix[0, 3] == pytest.approx(0.2 * waterfall.top)
    assert picture_of(waterfall).shape[0] == waterfall.top + 1
    shown = waterfall.top
    viewer.run(True)
    assert viewer.tow.top == viewer.tow.newest == shown, "the tow goes on from the ping that was scrubbed to"
    # The wheel looks back only when the tow is paused.
    viewer.tow.restart(500)
    viewer.run(True)
    waterfall.scrolled.emit(40)
    assert viewer.tow.top == viewer.tow.newest
    viewer.run(False)
    waterfall.scrolled.emit(40)
    assert viewer.tow.top == viewer.tow.newest - 40
    # Sentences go when they are read.
    window.status._fading.setInterval(30)
    window.say("saved it")
    qtbot.waitUntil(lambda: window.status.sentence.text() == "")
    window.say("this scene cannot be simulated", lasting=True)
    qtbot.wait(60)
    assert window.status.sentence.text() == "this scene cannot be simulated"
    viewer.run(True)
    assert window.status.sentence.text() == ""


def test_rows_below_ping_0_are_empty_old_pings_traced_again_and_the_scroll_bar_reaches_all(viewer, small, qtbot):
    waterfall = view = viewer.window.waterfall
    whole = waterfall.image.pixels.copy()
    finish(viewer, qtbot, viewer.go_to, 60)
    shown = waterfall.record.rows(np.arange(61))
    assert (waterfall.image.pixels[shown] == whole[shown]).all()
    hidden = waterfall.record.rows(np.arange(61, 128))
    assert (waterfall.image.pixels[hidden] == EMPTY).all(), "later pings would stand below the first one"
    viewer.session.show(gain=3.0)
    assert (waterfall.image.pixels[hidden] == EMPTY).all()
    viewer.session.show(gain=0.0)
    finish(viewer, qtbot, viewer.go_to, 127)
    assert (waterfall.image.pixels == whole).all()
    # The scroll bar shows every ping.
    known = np.flatnonzero(np.isfinite(view.overview.columns[:, 0]))
    assert known.size == small.track.pings
    strip = view.overview.draw(view.handle.room, view.handle.last, view.tone_map)
    assert (strip.width(), strip.height()) == (view.overview.columns.shape[1], view.handle.room)
    assert strip.pixel(2, 5) != EMPTY
    viewer.record.stamp[:4] += 3
    view.show_rows(np.arange(4))
    assert np.isfinite(view.overview.columns[:, 0]).sum() == 4, "a new edit begins anew"
    handle = view.handle
    handle.last = 127
    assert [handle.ping_at(handle.place_of(ping)) for ping in range(128)] == list(range(128))
    # Looking back traces the old pings again.
    first = picture_of(waterfall).copy()
    viewer.tow.restart(1000)
    finish(viewer, qtbot, viewer.run, False)
    assert set(viewer.record.ping) == set(range(873, 1001))
    finish(viewer, qtbot, viewer.look_back, 1000 - 127)
    assert waterfall.top == 127
    assert (picture_of(waterfall) == first).all()


def test_hover_tells_the_point_and_names_what_it_is(viewer, qtbot):
    waterfall, readout = viewer.window.waterfall, viewer.panels["readout"].widget
    mark = Mark(ping=100, side=1, bin=60)
    assert waterfall.mark_at(waterfall.place_of(mark)) == mark
    QTest.mouseMove(waterfall, waterfall.place_of(mark))
    waterfall.hovered.emit(mark)
    errors = viewer.panels["error"].widget
    assert errors.text() == "error: this ping 3 %, record 4.4 % of 3 %"  # √(2525 / 128)
    assert "slant 30.25 m" in readout.text(), "at once, and the rest a moment later"
    qtbot.waitUntil(lambda: "incidence" in readout.text())
    # Bin 60 of 100 over 50 m, sonar 10 m over the bed.
    for part in ("ping 100", "starboard", "slant 30.25 m", "ground 28.5", "bed, medium sand", "incidence 40°", "dB)"):
        assert part in readout.text()
    waterfall.hovered.emit(None)
    assert readout.text() == ""
    assert errors.text().startswith("error: this ping 2 %, "), "the newest, ping 127"
    # It names what a pixel is.
    for range_bin, told, untold in (
        (4, ["water column"], ["bed", "  ·  0", "dB"]),
        (70, ["pipe 1, steel", "incidence 40°"], ["bed"]),
        (71, ["shadow of pipe 1"], ["bed", "incidence"]),
        (72, ["bed, medium sand", "30 % in the shadow of pipe 1"], []),
        (80, ["ghost by surface and bottom (bed, medium sand)"], ["bed +", "bed -"]),
        (90, ["hidden by the bed"], ["incidence"]),
    ):
        waterfall.hovered.emit(Mark(ping=100, side=0, bin=range_bin))
        qtbot.waitUntil(lambda told=told: told[0] in readout.text())
        assert all(part in readout.text() for part in told)
        assert not any(part in readout.text() for part in untold)
    finish(viewer, qtbot, viewer.session.settle, {"volumes": [{"kind": "school", "position": [0.0, 10.0, -20.0]}]})
    waterfall.hovered.emit(Mark(ping=100, side=0, bin=5))
    qtbot.waitUntil(lambda: "school 1" in readout.text())
