"""The record panel: display options by clicks and keys, contrast, measuring, contacts and their files."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from controls import answer_questions, choose, colours_of, drag, finish, picture_of, press_shortcut
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPixmap
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QFileDialog, QMessageBox

from insonify.display.display_options import DisplayOptions
from insonify.explanation import pixel
from insonify.io.contacts import Contact, read_contacts
from insonify.scene import edit, load_scene
from insonify.simulation import Simulation, prepare
from insonify_viewer.application import keep_display
from insonify_viewer.panels.record import view as contact_list
from insonify_viewer.panels.record.view import TICKS
from insonify_viewer.record.echo_trace import draw_trace
from insonify_viewer.record.measuring import Location, locate_simulated, measure, round_shadow_height, shadow_height
from insonify_viewer.record.record_overlays import MOST_OPAQUE
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.painting import LIT
from insonify_viewer.window.settings import Settings


@pytest.fixture
def viewer(open_viewer, small):
    viewer = open_viewer(edit(small, {"sonar.bins": 400, "track.pings": 256}))
    viewer.window.open_panel("record")
    return viewer


@pytest.fixture
def panel(viewer):
    return viewer.panels["record"]


def test_options_follow_ticks_and_keys_and_levels_behind_a_tab_are_not_counted(viewer, panel, qtbot, monkeypatch):
    for name, _, key, _ in TICKS:
        viewer.window.open_panel("record")
        before = getattr(viewer.session.display, name)
        panel.view.ticks[name].click()
        assert getattr(viewer.session.display, name) is not before
        viewer.window.open_panel("parameters")  # the keys work while the panel is hidden
        press_shortcut(viewer.window, key)
        qtbot.waitUntil(lambda name=name, before=before: getattr(viewer.session.display, name) is before)
        assert panel.view.ticks[name].isChecked() is before
    for key, side in (("2", "port"), ("3", "starboard"), ("1", "both")):
        press_shortcut(viewer.window, key)
        qtbot.waitUntil(lambda side=side: viewer.session.display.side == side)
        assert panel.view.choices["side"].combo.currentText() == side
    press_shortcut(viewer.window, "t")
    qtbot.waitUntil(lambda: viewer.session.display.scale == "true")
    combo = panel.view.choices["palette"].combo
    choose(combo, 2)
    assert viewer.window.palettes.currentText() == viewer.session.display.palette == combo.currentText()
    # Levels behind a tab are not counted.
    asked, find = [], panel._find_levels
    monkeypatch.setattr(panel, "_find_levels", lambda: asked.append(True) or find())
    finish(viewer, qtbot, viewer.session.settle, {"track.altitude": 8.0})
    qtbot.wait(50)
    assert not asked
    viewer.window.open_panel("record")
    qtbot.waitUntil(lambda: bool(asked))


def test_display_options_are_undone_by_name_and_gains_typed(viewer, panel):
    window, session = viewer.window, viewer.session
    keep_display(viewer)
    assert not session.history.undoable, "what is kept from the last start is no step"
    traced = session.scene
    combo = panel.view.choices["palette"].combo
    for name in ("grey", "viridis"):
        choose(combo, name)
    panel.view.ticks["ground_range"].click()
    for tenths in (10, 20, 45):
        window.gain.setValue(tenths)
    assert session.history.undoable == ("gain", "ground range", "palette")
    assert Settings().display == {"palette": "viridis", "ground_range": True}
    assert window.undo.text() == "Undo: gain"
    window.undo.trigger()
    assert (window.gain.value(), panel.view.gains[0].field.text()) == (0, "0 dB")
    window.undo.trigger()
    assert not panel.view.ticks["ground_range"].isChecked()
    assert Settings().display == {"palette": "viridis"}
    window.undo.trigger()
    assert window.palettes.currentText() == "copper"
    assert Settings().display == {}, "the next start shows what is shown now"
    assert window.redo.text() == "Redo: palette"
    session.redo(3)
    assert session.display == DisplayOptions(palette="viridis", ground_range=True, gain=4.5)
    assert session.scene is traced
    assert not window.isWindowModified(), "the display is no part of the scene"
    # Contrast that is found from the record is a step of its own.
    window.gain.setValue(60)
    viewer.find_levels()
    assert session.history.undoable[:2] == ("contrast of the record", "gain")
    window.undo.trigger()
    assert window.gain.value() == 60
    # Gains of each side are typed.
    field = panel.view.gains[2].field
    for text in ("6", "loud"):  # the latter is no number
        field.setText(text)
        field.setModified(True)
        field.editingFinished.emit()
        assert viewer.session.display.side_gains == (0.0, 6.0)
    viewer.window.gain.setValue(45)
    assert panel.view.gains[0].field.text() == "4.5 dB"


def test_the_ends_of_the_colour_bar_are_dragged_and_a_drag_measures_in_every_view(viewer, panel, qtbot):
    histogram, view = panel.view.histogram, viewer.window.waterfall
    qtbot.waitUntil(lambda: histogram.counts.max() == 1.0)
    before = picture_of(view).copy()
    drag(histogram.surface, *(histogram.place_of(level, 0.5) for level in (histogram.ends[1], 20.0)))
    assert histogram.ends[1] == pytest.approx(20.0, abs=0.5)
    assert viewer.session.display.levels[1] == view.tone_map.ends[1] == pytest.approx(10.0, rel=0.05)
    darker = picture_of(view).copy()
    assert (darker != before).mean() > 0.5
    histogram.setFocus()
    QTest.keyClick(histogram, Qt.Key.Key_Left)
    assert histogram.ends[1] == pytest.approx(19.5, abs=0.5)
    viewer.find_levels()
    assert viewer.session.display.levels is None
    assert (picture_of(view) == before).all()
    # A drag measures in every view.
    first, last = Mark(200, 1, 200), Mark(180, 1, 300)
    found = []
    view.measured.connect(lambda a, b: found.append((a, b)))
    press_shortcut(viewer.window, "m")
    assert view.measuring
    for options in ({}, {"ground_range": True}, {"side": "starboard", "newest_on_top": False}, {"water_column": False}):
        viewer.session.show(**options)
        top = view.top
        drag(view, view.place_of(first), view.place_of(last))
        assert view.top == top, "a drag that measures does not move the record"
        for mark, wanted in zip(found[-1], (first, last)):
            assert (mark.ping, mark.bin) == (pytest.approx(wanted.ping, abs=1), pytest.approx(wanted.bin, abs=1))
        along, across = (float(word.split()[0]) for word in panel.view.measured.text().split(": ")[1].split(", ")[:2])
        slants = np.array([200.5, 300.5]) * 50.0 / 400
        wide = np.diff(np.sqrt(slants**2 - 10.0**2))[0]
        assert along == pytest.approx(20 * 0.2, abs=0.45)
        assert across == pytest.approx(wide, abs=0.4)
    press_shortcut(viewer.window, "m")
    assert not view.measuring
    assert view.marks.line is None


def mark_two(viewer, panel, qtbot):
    view = viewer.window.waterfall
    for number, mark in enumerate((Mark(240, 0, 300), Mark(60, 1, 200)), start=1):
        QTest.mouseMove(view, view.place_of(mark))
        qtbot.waitUntil(lambda: panel.hovered is not None)
        panel.hovered = (view, mark)  # to the bin, which the mouse meets to a pixel
        press_shortcut(viewer.window, "c")
        qtbot.waitUntil(lambda number=number: len(panel.contacts) == number)


def test_contacts_are_marked_classed_measured_sorted_named_and_found_again(viewer, panel, qtbot, tmp_path, monkeypatch):
    window, view, listed = viewer.window, viewer.window.waterfall, panel.view.contacts
    mark_two(viewer, panel, qtbot)
    assert [listed.list.item(row, 1).text() for row in range(2)] == ["contact 1", "contact 2"]
    contact = panel.contacts[0]
    assert (contact.ping, contact.side, contact.range_bin) == (240, "port", 300)
    assert contact.y == pytest.approx(np.sqrt((300.5 / 8) ** 2 - 100.0), abs=0.05)
    picture = QPixmap()
    assert picture.loadFromData(contact.snapshot)
    assert picture.width() == picture.height() == 128
    listed.choose(0)
    listed.takes["height"].click()
    assert "measure first" in window.status.sentence.text()
    ends = Mark(240, 0, 250), Mark(240, 0, 300)
    view.measured.emit(*ends)
    line = measure(*(locate_simulated(viewer.answer.simulation, end) for end in ends))
    for field in ("length", "height"):
        listed.takes[field].click()
    assert panel.contacts[0].length == pytest.approx(line.straight, abs=0.005)
    assert panel.contacts[0].height == pytest.approx(line.height, abs=0.005)
    assert window.undo.text() == "Undo: height of contact 1"
    listed.classification.textActivated.emit("wreck")
    listed.sizes["height"].setValue(0.0)
    assert (panel.contacts[0].classification, panel.contacts[0].height) == ("wreck", None)
    listed.list.sortItems(8, Qt.SortOrder.DescendingOrder)
    assert [listed.list.item(row, 1).text() for row in range(2)] == ["contact 1", "contact 2"], "the farther first"
    listed.list.sortItems(8)
    listed.list.setCurrentCell(0, 0)
    listed.note.setText("a stone")
    listed.note.editingFinished.emit()
    assert panel.contacts[1].note == "a stone"
    assert listed.list.item(0, 10).text() == "a stone", "it stays sorted"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "found.html"), ""))
    listed.report.click()
    assert "a stone" in (tmp_path / "found.html").read_text(encoding="utf-8")
    assert panel.contacts.unsaved, "a report is no list that can be opened"
    # They are named, and found again.
    listed.choose(0)
    listed.name.setText("wreck")
    listed.name.editingFinished.emit()
    listed.note.setText("two masts")
    listed.note.editingFinished.emit()
    assert (panel.contacts[0].name, panel.contacts[0].note) == ("wreck", "two masts")
    assert (Mark(240, 0, 300), "wreck", True) in view.marks.contacts
    viewer.go_to(100)
    assert (Mark(240, 0, 300), "wreck", True) in view.marks.contacts, "contacts outlast scrolling"
    listed.jump.click()
    assert view.plot_area.contains(view.place_of(Mark(240, 0, 300)))
    listed.remove.click()
    assert [each.name for each in panel.contacts.all] == ["contact 2"]


def test_entries_of_contacts_that_stay_are_not_made_again(monkeypatch, qtbot):
    made = []
    items = contact_list._items
    monkeypatch.setattr(contact_list, "_items", lambda *contact: made.append(contact[1].name) or items(*contact))
    view = contact_list.ContactListView()
    qtbot.addWidget(view)
    contacts = [Contact(name, "", "default", 3, "port", 7, 2.0) for name in "abcd"]
    view.show_contacts(contacts)
    view.show_contacts(contacts)
    contacts[1] = replace(contacts[1], name="x")
    view.show_contacts(contacts)
    view.show_contacts(contacts[:3])
    assert made == ["a", "b", "c", "d", "x"]
    texts = [view.list.item(row, 1).text() for row in range(view.list.rowCount())]
    assert texts == ["a", "x", "c"]


def test_contacts_are_undone_in_turn_with_the_scene_saved_and_asked_about(viewer, panel, qtbot, tmp_path, monkeypatch):
    listed, window = panel.view.contacts, viewer.window
    assert not window.isWindowModified()
    mark_two(viewer, panel, qtbot)
    assert window.isWindowModified()
    viewer.session.settle({"track.altitude": 8.0})
    listed.choose(0)
    listed.note.setText("two masts")
    listed.note.editingFinished.emit()
    before = panel.contacts.all
    listed.remove.click()
    assert window.undo.text() == "Undo: contact 1 removed"
    window.undo.trigger()
    assert panel.contacts.all == before
    assert listed.list.item(0, 1).text() == "contact 1"
    assert listed.row == 0, "the one that is there again"
    assert window.redo.text() == "Redo: contact 1 removed"
    assert viewer.session.history.undoable == ("note on contact 1", "altitude", "contact 2 marked", "contact 1 marked")
    scene = viewer.session.scene
    window.undo.trigger()
    assert panel.contacts[0].note == ""
    assert viewer.session.scene is scene
    window.undo.trigger()
    assert viewer.session.scene.track.altitude == 10.0
    assert len(panel.contacts) == 2
    window.undo.trigger()
    window.undo.trigger()
    assert not window.undo.isEnabled()
    assert listed.list.rowCount() == 0
    viewer.session.redo(5)
    assert [each.name for each in panel.contacts.all] == ["contact 2"]
    # They are saved and opened.
    viewer.session.undo()
    path = tmp_path / "found.geojson"
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    listed.save.click()
    assert not panel.contacts.unsaved
    assert len(read_contacts(path)) == 2
    listed.remove.click()
    assert panel.contacts.unsaved
    listed.open.click()
    assert [each.name for each in panel.contacts.all] == ["contact 1", "contact 2"]
    path.write_text("nonsense", encoding="utf-8")
    listed.open.click()
    assert "is not a file of contacts" in window.status.sentence.text()
    assert len(panel.contacts) == 2
    # One question stands for scene and contacts.
    panel.contacts.open([], "")
    mark_two(viewer, panel, qtbot)
    viewer.session.settle({"track.altitude": 7.0})
    asked = answer_questions(monkeypatch, QMessageBox.StandardButton.Save)
    named = [str(tmp_path / "scene.toml"), "", str(path)]
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (named.pop(0), ""))
    assert not window.close(), "the dialog for the contacts is left"
    assert load_scene(tmp_path / "scene.toml").track.altitude == 7.0
    assert window.close()
    assert asked == [
        f"The scene “{viewer.session.scene.title}” and the list of 2 contacts have changes that are not saved.",
        "The list of 2 contacts has changes that are not saved.",
    ]
    assert len(read_contacts(path)) == 2


ALTITUDE, RANGE, BINS = 10.0, 50.0, 2000
PING = 100


def scene_with(target: dict[str, Any], **changes):
    flat = {
        "seabed.relief": "flat", "sonar.range": RANGE, "sonar.bins": BINS, "sonar.beam": "knife",
        "sonar.pulse": "ideal", "track.altitude": ALTITUDE, "track.pings": 200,
    }  # fmt: skip
    empty = edit(load_scene("default"), {"targets": []} | flat)
    return edit(empty, {"targets": [target]} | changes)


def shadow_of(simulation: Simulation, across: float) -> tuple[Mark, Mark]:
    """Last bin of the target's echo before its shadow, and first bin of the bed behind it, on the port side."""
    heard = simulation.intensity(np.array([PING]))[0, 0] > 0.0
    behind = int(math.hypot(across, ALTITUDE) * BINS / RANGE)
    first = behind - 60 + int(np.argmax(~heard[behind - 60 :]))
    last = first + int(np.argmax(heard[first:]))
    return Mark(PING, 0, first - 1), Mark(PING, 0, last)


def tangent_ranges(across: float, radius: float) -> tuple[float, float]:
    """Slant ranges at which the two tangents from the sonar to a circle on the bed meet the bed."""
    down = math.atan2(ALTITUDE - radius, across)
    half = math.asin(radius / math.hypot(across, ALTITUDE - radius))
    return ALTITUDE / math.sin(down + half), ALTITUDE / math.sin(down - half)


@pytest.mark.parametrize("across", [15.0, 20.0, 28.0])
@pytest.mark.parametrize("radius", [0.25, 0.5, 1.0])
@pytest.mark.parametrize("kind", ["pipe", "sphere"])
def test_heights_from_shadows_are_those_of_the_targets(kind, radius, across):
    """h = A L / (R + L) is within two bins of what a circle on a line gives, and 4 to 16 % below the top.

    The last ray touches the body below its top, and the bed heard in front of the body begins the shadow later.
    """
    size = {"length": 30.0, "gap": 0.0} if kind == "pipe" else {}
    place = {"kind": kind, "radius": radius, "position": [PING * 0.2, across], "heading": 0.0} | size
    simulation = prepare(scene_with(place), method="sweep")
    ends = [locate_simulated(simulation, mark) for mark in shadow_of(simulation, across)]
    measured = measure(*ends)
    found, of_round = measured.height, measured.round_height
    begins, ends_at = tangent_ranges(across, radius)
    begins = max(math.sqrt(across**2 + ALTITUDE**2 - 2.0 * ALTITUDE * radius), begins)  # length of a tangent
    width = 2.0 * ALTITUDE * (RANGE / BINS) / begins  # height of two bins
    assert found == pytest.approx(ALTITUDE * (ends_at - begins) / ends_at, abs=width)
    error = found / (2.0 * radius) - 1.0
    assert -0.16 < error < 0.0
    ground = math.sqrt(begins**2 - ALTITUDE**2)
    assert of_round == pytest.approx(2.0 * radius, abs=width * begins / ground), "of two bins, d h = A d R / G"
    assert f"{found:.2f} m high, {of_round:.2f} m if round" in measured.words


def test_the_height_of_a_round_body_follows_from_tangents_to_a_circle():
    """A circle of 0.7 m radius on the bed, 18 m away: its two tangents from the sonar meet the bed at both ends."""
    begins, ends = tangent_ranges(18.0, 0.7)
    assert round_shadow_height(ALTITUDE, begins, ends - begins) == pytest.approx(2.0 * 0.7, rel=1e-12)
    assert round_shadow_height(ALTITUDE, begins, 0.0) == 0.0
    # A shadow without length has no height, and a long one nears the altitude.
    assert [shadow_height(10.0, *each) for each in ((20.0, 5.0), (1.0, 1e9))] == pytest.approx([2.0, 10.0])
    assert shadow_height(10.0, 20.0, 0.0) == 0.0


@pytest.mark.parametrize("heading", [0.0, 37.0, 180.0])
def test_distances_are_those_on_the_bed(heading):
    sphere = {"kind": "sphere", "radius": 0.5, "position": [5.0, 500.0]}
    simulation = prepare(scene_with(sphere, **{"track.heading": heading}), method="sweep")
    first, last = (locate_simulated(simulation, mark) for mark in (Mark(20, 0, 1200), Mark(80, 1, 900)))
    found = measure(first, last)
    slants = [(bin_ + 0.5) * RANGE / BINS for bin_ in (1200, 900)]
    across = sum(math.sqrt(slant**2 - ALTITUDE**2) for slant in slants)
    assert found.along == pytest.approx(60 * 0.2, abs=1e-6)
    assert found.across == pytest.approx(across, abs=1e-6)
    assert found.straight == pytest.approx(math.hypot(12.0, across), abs=1e-6)
    assert (found.slant, found.pings) == (pytest.approx(slants[0] - slants[1]), 60)
    assert found.height is None, "no shadow reaches over both sides"
    assert found.words.startswith(f"{found.straight:.2f} m on the bed")
    # In the water column slant range alone is known.
    first = Location(Mark(3, 0, 10), 0.5, None, None, 10.0, 0.0)
    last = Location(Mark(5, 0, 100), 5.0, None, None, 10.0, 0.0)
    assert measure(first, last).words == "slant range 4.50 m, 2 pings"


def test_what_is_no_number_is_silent(qapp):
    drawn = []
    for loudest in ([1.0, np.nan, 0.1, np.nan], [1.0, 0.0, 0.1, 0.0]):
        drawn.append(QImage(200, 120, QImage.Format.Format_RGB32))
        drawn[-1].fill(0)
        with QPainter(drawn[-1]) as painter:
            draw_trace(painter, QRect(0, 20, 200, 100), np.repeat(np.float32(loudest), 50), "echo of ping 1", None)
    assert drawn[0] == drawn[1]


def test_errors_of_bins_lie_over_their_bins_and_are_taken_off(viewer, panel, qtbot, monkeypatch):
    view = viewer.window.waterfall
    share = 1.5 * viewer.session.modelling.tolerance  # half of that in full colour
    errors = np.array([[0.0], [share]], np.float32)
    asked: list[int] = []

    def find_errors(_, pings):
        asked.extend(pings.tolist())
        return np.broadcast_to(errors, (len(pings), 2, view.record.bins))

    monkeypatch.setattr(pixel, "find_bin_errors", find_errors)
    plain, plot, middle = colours_of(view.grab().toImage()), view.plot_area, view.plot_area.center()
    panel.view.errors.setChecked(True)
    qtbot.waitUntil(lambda: view.errors.shares.any(axis=1).all())
    assert sorted(asked) == list(range(view.record.pings)), "every ping on screen, once"
    over = colours_of(view.grab().toImage())
    changed = (over != plain)[plot.top() : plot.bottom(), :]
    assert not changed[:, : middle.x() - 1].any(), "port has no error"
    assert changed[:, middle.x() + 2 : plot.right()].mean() > 0.9
    mixed = np.array(QColor.fromRgb(int(plain[middle.y(), middle.x() + 40])).getRgb()[:3], float)
    mixed += 0.5 * MOST_OPAQUE / 255.0 * (np.array(QColor(LIT).getRgb()[:3]) - mixed)
    found = QColor.fromRgb(int(over[middle.y(), middle.x() + 40])).getRgb()[:3]
    np.testing.assert_allclose(found, mixed, atol=10)  # a screen may have 16 bits
    panel.view.errors.setChecked(False)
    assert (colours_of(view.grab().toImage()) == plain).all()
