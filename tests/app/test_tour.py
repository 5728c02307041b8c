"""The tour of the window: five steps, each beside its part, left at any time."""

import pytest
from controls import activate
from PySide6.QtCore import QRect, Qt
from PySide6.QtWidgets import QApplication

from insonify_viewer import application
from insonify_viewer.window.settings import Settings


def begin(viewer):
    """Begin the tour by the menu, as a person does."""
    (action,) = [action for action in viewer.window.menus.help.actions() if action.text() == "Tour"]
    action.trigger()
    return viewer.window.tour


def test_five_steps_lead_through_the_window_back_and_out(viewer, qtbot):
    tour = begin(viewer)
    titles = []
    while tour.card is not None:
        titles.append(tour.card.title.text())
        assert viewer.window.rect().contains(QRect(tour.card.pos(), tour.card.size()))
        assert tour.card.words.height() >= tour.card.words.heightForWidth(tour.card.words.width())
        qtbot.mouseClick(tour.card.next, Qt.MouseButton.LeftButton)
    assert [title.split(":")[0] for title in titles] == [f"{number} of 5" for number in range(1, 6)]
    # It goes back and is skipped while the window stays free.
    tour = begin(viewer)
    assert not tour.card.back.isEnabled()
    qtbot.mouseClick(tour.card.next, Qt.MouseButton.LeftButton)
    qtbot.mouseClick(tour.card.back, Qt.MouseButton.LeftButton)
    assert tour.card.title.text().startswith("1 of 5")
    assert viewer.session.settle({"track.altitude": 7.0})
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
