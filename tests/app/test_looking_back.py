"""Earlier pings in the window: the handle, the wheel and the button that pauses."""

import numpy as np
import pytest
from controls import picture_of
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from insonify_viewer.record.record_image import EMPTY


def test_looking_back_traces_the_old_pings_again(viewer, qtbot):
    first = picture_of(viewer.window.waterfall).copy()
    viewer.tow.restart(1000)
    viewer.run(False)
    qtbot.waitUntil(lambda: viewer.complete)
    assert set(viewer.record.ping) == set(range(873, 1001))
    viewer.look_back(1000 - 127)
    qtbot.waitUntil(lambda: viewer.complete)
    assert viewer.window.waterfall.top == 127
    assert (picture_of(viewer.window.waterfall) == first).all()


def test_the_handle_brings_the_fish_abeam_of_the_pipe(viewer, qtbot):
    waterfall, handle = viewer.window.waterfall, viewer.window.waterfall._handle
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
    assert viewer.seabed.view._fish_actor.user_matrix[0, 3] == pytest.approx(0.2 * waterfall.top)
    assert picture_of(waterfall).shape[0] == waterfall.top + 1
    shown = waterfall.top
    viewer.run(True)
    assert viewer.tow.top == viewer.tow.newest == shown, "the tow goes on from the ping that was scrubbed to"


def test_below_the_first_ping_the_record_is_empty_and_the_scroll_bar_shows_and_reaches_every_ping(viewer, small, qtbot):
    waterfall = view = viewer.window.waterfall
    whole = waterfall.image.pixels.copy()
    viewer.go_to(60)
    qtbot.waitUntil(lambda: viewer.complete)
    shown = waterfall.record.rows(np.arange(61))
    assert (waterfall.image.pixels[shown] == whole[shown]).all()
    hidden = waterfall.record.rows(np.arange(61, 128))
    assert (waterfall.image.pixels[hidden] == EMPTY).all(), "later pings would stand below the first one"
    viewer.session.show(gain=3.0)
    assert (waterfall.image.pixels[hidden] == EMPTY).all()
    viewer.session.show(gain=0.0)
    viewer.go_to(127)
    qtbot.waitUntil(lambda: viewer.complete)
    assert (waterfall.image.pixels == whole).all()
    # The scroll bar shows every ping.
    known = np.flatnonzero(np.isfinite(view.overview._columns[:, 0]))
    assert known.size == small.track.pings
    strip = view.overview.draw(view._handle.room, view._handle.last, view.tone_map)
    assert (strip.width(), strip.height()) == (view.overview._columns.shape[1], view._handle.room)
    assert strip.pixel(2, 5) != EMPTY
    viewer.record.stamp[:4] += 3
    view.show_rows(np.arange(4))
    assert np.isfinite(view.overview._columns[:, 0]).sum() == 4, "a new edit begins anew"
    handle = view._handle
    handle.last = 127
    assert [handle.ping_at(handle.place_of(ping)) for ping in range(128)] == list(range(128))


def test_the_button_says_what_it_does_the_wheel_looks_back_and_sentences_go(viewer, window, qtbot):
    assert (window.pause.text(), window.pause.isChecked()) == ("Play", True)
    window.pause.trigger()
    assert (window.pause.text(), window.pause.isChecked()) == ("Pause", False)
    assert "Space" in window.pause.toolTip()
    # The wheel looks back only when the tow is paused.
    viewer.tow.restart(500)
    viewer.run(True)
    viewer.window.waterfall.scrolled.emit(40)
    assert viewer.tow.top == viewer.tow.newest
    viewer.run(False)
    viewer.window.waterfall.scrolled.emit(40)
    assert viewer.tow.top == viewer.tow.newest - 40
    # Sentences go when they are read.
    viewer.window.status._fading.setInterval(30)
    viewer.window.say("saved it")
    qtbot.waitUntil(lambda: viewer.window.status.sentence.text() == "")
    viewer.window.say("this scene cannot be simulated", lasting=True)
    qtbot.wait(60)
    assert viewer.window.status.sentence.text() == "this scene cannot be simulated"
    viewer.run(True)
    assert viewer.window.status.sentence.text() == ""
