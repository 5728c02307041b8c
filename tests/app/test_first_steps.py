"""What a person reaches who never saw the window, within three actions of its opening, and the tour of its parts."""

from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from controls import activate, drag
from PySide6.QtCore import QPoint, QRect, Qt, QTimer
from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLineEdit

from insonify.scene import DEFAULT_SCENE, bundled_scenes, load_scene
from insonify_viewer import application
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.gallery import Gallery
from insonify_viewer.window.settings import Settings

MOST = 3  # actions
ROLE = Qt.ItemDataRole.UserRole


@pytest.fixture
def hand():
    """Do what a person does with mouse and keys, and count it: a click, a drag, a key, or a typed line is one."""
    return Mock(side_effect=lambda act, *given: act(*given))


@pytest.fixture
def viewer(open_viewer, qtbot):
    """The window on the default scene, as it opens: the tow runs."""
    viewer = open_viewer(load_scene("default"), prepare=None)
    activate(viewer.window, qtbot)
    viewer.run(True)
    return viewer


def click(widget, place: QPoint):
    QTest.mouseMove(widget, place)
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton, pos=place)


def when_it_opens(window_type: type, do: Callable[[Any], None]):
    """Do something in a dialog as soon as it takes keys, up to 4 minutes from now."""

    def look(left: int = 4800):
        dialog = QApplication.activeModalWidget()
        if isinstance(dialog, window_type) and dialog.isActiveWindow():
            do(dialog)
        elif left:
            QTimer.singleShot(50, lambda: look(left - 1))

    look()


def test_a_picture_is_saved_and_another_scene_gives_its_record(viewer, hand, qtbot, tmp_path):
    window, path = viewer.window, tmp_path / "mine.png"

    def name(dialog):
        line = dialog.findChild(QLineEdit)
        assert dialog.focusWidget() is line, "it takes what is typed at once"
        line.setCompleter(None)  # its list comes up at once or a moment later, and would take the key
        line.selectAll()
        hand(QTest.keyClicks, line, str(path))
        hand(QTest.keyClick, line, Qt.Key.Key_Return)

    when_it_opens(QFileDialog, name)
    hand(QTest.keyClick, window, Qt.Key.Key_P, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(path.exists)
    assert not QImage(str(path)).isNull()
    assert hand.call_count <= MOST
    # The window is as it opened.
    hand.reset_mock()

    hand(click, window.scenes, window.scenes.rect().center())
    qtbot.waitUntil(lambda: window.findChild(Gallery) is not None)
    pictures = window.findChild(Gallery).list
    files = [(item, item.data(ROLE)) for item in map(pictures.item, range(pictures.count()))]
    heads, names = [item.text() for item, file in files if file is None], [Path(file).stem for _, file in files if file]
    assert heads == ["As at sea", *heads[1:-1], "Where it breaks"]
    assert sorted(names) == sorted(bundled_scenes())
    breaking = [name.startswith("breaks-") for name in names]
    assert breaking == sorted(breaking), "scenes on which a method fails come last"
    assert names[0] == DEFAULT_SCENE
    item = next(item for item, file in files if file and "pipe-on-bed" in file)
    pictures.scrollToItem(item)
    qtbot.waitUntil(lambda: pictures.visualItemRect(item).isValid())
    hand(click, pictures.viewport(), pictures.visualItemRect(item).center())
    assert viewer.session.scene == load_scene("pipe-on-bed")
    qtbot.waitUntil(lambda: viewer.complete, timeout=240000)
    assert hand.call_count <= MOST


def test_a_target_is_moved_and_a_shadow_explained(viewer, hand, qtbot):
    before, record, panel = viewer.session.scene.targets, viewer.window.waterfall, viewer.panels["pixel"]
    hand(QTest.keyClick, record, Qt.Key.Key_Space)
    assert not viewer.tow.running
    # The handle nearest to the middle of the record.
    places = [record.handles.place(k) for k in range(len(viewer.targets.handles.all))]
    start = min(places, key=lambda place: (place - record.rect().center()).manhattanLength())
    hand(drag, record, start, start + QPoint(30, 20))
    assert viewer.session.history.undoable[0].endswith("moved")
    moved = [a.position != b.position for a, b in zip(before, viewer.session.scene.targets)]
    assert moved.count(True) == 1
    qtbot.waitUntil(lambda: viewer.complete)
    # The middle of the longest shadow on screen.
    pings = record.top - np.arange(20, viewer.record.pings // 2, 8)
    shadow = viewer.answer.simulation.truth(pings).shadow == 1.0
    row, side = np.unravel_index(int(shadow.sum(axis=2).argmax()), shadow.shape[:2])
    bins = np.flatnonzero(shadow[row, side])
    hand(click, record, record.place_of(Mark(int(pings[row]), int(side), int(np.median(bins)))))
    qtbot.waitUntil(lambda: panel.complete, timeout=240000)
    assert panel.view.isVisible()
    assert "shadow of" in panel.view.summary.text()
    assert hand.call_count <= MOST


def begin(viewer):
    """Begin the tour by the menu, as a person does."""
    (action,) = [action for action in viewer.window.menus.help.actions() if action.text() == "Tour"]
    action.trigger()
    return viewer.window.tour


def test_five_steps_lead_through_the_window_back_and_out(open_viewer, small, qtbot):
    viewer = open_viewer(small)
    tour, titles, hands = begin(viewer), [], set()
    while tour.card is not None:
        titles.append(tour.card.title.text())
        hands.add(tour.card.next.mapTo(viewer.window, tour.card.next.rect().bottomRight()).toTuple())
        assert viewer.window.rect().contains(QRect(tour.card.pos(), tour.card.size()))
        assert tour.card.words.height() >= tour.card.words.heightForWidth(tour.card.words.width())
        qtbot.mouseClick(tour.card.next, Qt.MouseButton.LeftButton)
    assert len(hands) == 1, "the button stays under the hand"
    assert [title.split(":")[0] for title in titles] == [f"{number} of 5" for number in range(1, 6)]
    # It goes back and is skipped while the window stays free.
    tour = begin(viewer)
    assert not tour.card.back.isEnabled()
    qtbot.mouseClick(tour.card.next, Qt.MouseButton.LeftButton)
    qtbot.mouseClick(tour.card.back, Qt.MouseButton.LeftButton)
    assert tour.card.title.text().startswith("1 of 5")
    assert viewer.session.settle({"track.altitude": 7.0})
    # The frame follows its widget.
    qtbot.mouseClick(tour.card.next, Qt.MouseButton.LeftButton)
    dock = viewer.window.docks.by_panel["parameters"]
    viewer.window.resizeDocks([dock], [dock.width() + 40], Qt.Orientation.Horizontal)
    qtbot.waitUntil(lambda: tour._outline.geometry() == QRect(dock.mapTo(viewer.window, QPoint(0, 0)), dock.size()))
    viewer.window.resize(960, 600)
    assert viewer.window.rect().contains(tour.card.geometry())
    qtbot.mouseClick(tour.card.skip, Qt.MouseButton.LeftButton)
    assert tour.card is None
    # Escape leaves it.
    window = viewer.window
    activate(window, qtbot)
    window.waterfall.setFocus()
    tour = begin(viewer)
    assert QApplication.focusWidget() is tour.card.next
    qtbot.keyClick(tour.card.next, Qt.Key.Key_Escape)
    assert tour.card is None
    assert QApplication.focusWidget() is window.waterfall, "the keyboard is where it was"
    for elsewhere in (window.waterfall, window.palettes):
        begin(viewer)
        elsewhere.setFocus()
        qtbot.keyClick(elsewhere, Qt.Key.Key_Escape)
        assert tour.card is None
        assert QApplication.focusWidget() is elsewhere


@pytest.mark.parametrize(("toured", "panel", "shown"), [(False, "", 1), (True, "", 0), (False, "record", 0)])
def test_the_first_start_alone_shows_the_tour(small, qapp, monkeypatch, toured, panel, shown):
    begun = []
    Settings().toured = toured
    monkeypatch.setattr(application, "TOUR", 0)
    monkeypatch.setattr("insonify_viewer.window.tour.Tour.begin", lambda _: begun.append(1))
    monkeypatch.setattr("insonify_viewer.viewer.Viewer.start", lambda self: self.window.close())
    monkeypatch.setattr(type(qapp), "exec", lambda *_: [qapp.processEvents() for _ in range(20)] and 0)
    assert application.open_window(small, panel=panel) == 0
    assert len(begun) == shown
    assert Settings().toured == (toured or shown > 0)
