"""Record A beside the live record: kept, shown by a key, wiped, subtracted, measured, returned to."""

import numpy as np
import pytest
from controls import activate, bring_to_front, choose, colours_of, drag, finish, press_shortcut
from PIL import Image
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QAbstractSlider, QApplication, QComboBox, QLineEdit, QListWidget, QTabBar

from insonify.cli import main
from insonify.scene import edit, load_partner, load_scene
from insonify_viewer.record.comparison.arrangement import Arrangement, find_pairs
from insonify_viewer.record.comparison.comparison_overlay import SPANS, decibels_between, draw_difference
from insonify_viewer.record.comparison.kept_record import list_changes
from insonify_viewer.record.comparison.record_difference import (
    RecordDifference,
    RecordSnapshot,
    are_comparable,
    compare_records,
    visible_share,
)
from insonify_viewer.record.projection import Zoom
from insonify_viewer.record.record import Record
from insonify_viewer.state.history import Modelling

DARK, LIGHT = {"seabed.material.diffuse": 0.2}, {"seabed.material.diffuse": 0.4}
GREY = np.array([0xFF000000 | k << 16 | k << 8 | k for k in range(256)], np.uint32)


def heard(intensity: np.ndarray, scene, *, first: int = 0) -> RecordSnapshot:
    record = Record(len(intensity), intensity.shape[2])
    record.put(np.arange(first, first + len(intensity)), np.sqrt(intensity).astype(np.float32), 1)
    return RecordSnapshot.of(record, scene)


def test_a_difference_is_the_rms_beyond_near_bins_of_pings_in_both(small):
    random = np.random.default_rng(5)
    one = random.uniform(0.5, 2.0, (40, 2, 100))
    other = one * random.normal(1.0, 0.1, one.shape) ** 2
    other[:, :, :28] = 9.0  # nearer than 1.4 altitudes of 10 m, of bins of 0.5 m
    far = slice(28, None)
    expected = np.linalg.norm((other - one)[:, :, far]) / np.linalg.norm(one[:, :, far])
    before, after = heard(one, small), heard(other, small)
    found = compare_records(before, after)
    assert found.share == pytest.approx(expected, rel=1e-5)
    level = 10.0 * np.log10(other[:, :, far].sum() / one[:, :, far].sum())
    assert found.decibels == pytest.approx(level, abs=1e-4)
    later = compare_records(before, heard(other[20:], small, first=20))
    expected = np.linalg.norm((other - one)[20:, :, far]) / np.linalg.norm(one[20:, :, far])
    assert later.share == pytest.approx(expected, rel=1e-5)
    assert compare_records(before, heard(other, small, first=30)) is None
    assert compare_records(before, before) == (0.0, 0.0, 0.0)


def test_a_bright_line_rules_the_rms_and_not_what_is_seen():
    """One bin in a hundred, 100 times the bed, falls by 3 dB; a fifth of the bins is dark in both records."""
    one = np.ones((20, 100), np.float32)
    one[:, 7], one[:, 80:] = 100.0, 0.0
    other = one.copy()
    other[:, 7] = 50.0
    assert visible_share(one, other) == pytest.approx(1.0 / 80.0)
    assert visible_share(other, one) == pytest.approx(1.0 / 80.0)
    assert visible_share(one, one * np.float32(10.0**0.099)) == 0.0
    assert visible_share(one, one * np.float32(10.0**0.101)) == 1.0
    assert visible_share(one, np.where(one == 0.0, np.float32(1e-5), one)) == 0.0, "darker than any palette shows"
    other[:, 80:90] = 0.01
    assert visible_share(one, other) == pytest.approx(11.0 / 90.0), "what comes out of the dark is seen"
    assert visible_share(np.zeros_like(one), np.zeros_like(one)) == 0.0


def test_a_difference_is_given_in_words_and_changes_name_fields_and_choices(small):
    words = {
        (0.0, 0.0, 0.0): "does not change the record",
        (0.123, -0.84, 0.036): "changes the record by 12 %, 3.6 % of its picture visibly, its mean level by −0.84 dB",
        (0.004, 0.001, 0.0): "changes the record by 0.4 %, not visibly",
    }
    assert {numbers: RecordDifference(*numbers).in_words() for numbers in words} == words
    comparable = {("sonar.bins", 200): False, ("sonar.range", 40.0): False, ("track.altitude", 7.0): True}
    assert {change: are_comparable(small, edit(small, dict([change]))) for change in comparable} == comparable
    auto = Modelling()
    other = edit(small, {"sonar.beam.width": 2.5, "targets": []})
    named = [change.in_words() for change in list_changes((small, auto), (other, auto))]
    assert "beam width 1 → 2.5" in named
    assert "pipe 1 pipe → none" in named
    assert len(named) == 1 + len(small.targets), "of a target that is gone the kind alone"
    knife = edit(small, {"sonar.beam": "knife"})
    assert list_changes((small, auto), (knife, auto)) == [("beam", "fan", "knife")]
    assert list_changes((small, auto), (edit(small, {"title": "Other"}), auto)) == []
    tolerant = Modelling(0.1, (("planes", "16"),))
    changes = [("tolerance", "3 %", "10 %"), ("planes", "automatic", "16")]
    assert list_changes((small, auto), (small, tolerant)) == changes


def test_decibels_are_paired_bounded_and_drawn_between_the_smallest_ends_that_hold_them():
    a = np.array([[1.0, 1.0], [2.0, 0.0], [1.0, 1.0]], np.float32), np.array([True, True, False])
    b = np.array([[10.0, 1.0], [2.0, 0.0], [1.0, 1.0]], np.float32), np.array([True, True, True])
    found = decibels_between(a, b, np.arange(3))
    np.testing.assert_allclose(found[:2], [[20.0, 0.0], [0.0, 0.0]], atol=1e-3)
    assert np.isnan(found[2]).all(), "A lacks that ping"
    found = decibels_between(a, b, np.array([1, -1, 9]))
    np.testing.assert_allclose(found[0], [13.98, 40.0], atol=0.01)
    assert np.isnan(found[1:]).all()
    a[0][0, 1] = -1.0  # beyond the last bin of A
    assert np.isnan(decibels_between(a, b, np.arange(3))[0, 1])
    decibels = np.full((40, 50), 1.4, np.float32)
    decibels[0, 0] = np.nan
    decibels[1, 0] = 30.0  # too few to count
    picture = draw_difference(decibels, GREY, 0xFF123456)
    assert picture.span == 2.0
    assert picture.pixels[0, 0] == 0xFF123456
    assert picture.pixels[1, 0] == GREY[255]
    assert picture.pixels[5, 5] == GREY[int(127.5 + 127.5 * 0.7)]
    assert draw_difference(np.full((4, 4), 99.0, np.float32), GREY, 0).span == SPANS[-1]
    assert draw_difference(np.zeros((0, 4), np.float32), GREY, 0).span == SPANS[0]


@pytest.fixture
def compared(open_viewer, small, qtbot):
    """A window with a dark record as A and one twice as high as B."""
    viewer = open_viewer(edit(small, DARK))
    press_shortcut(viewer.window, "K")
    assert viewer.comparison.kept is not None
    finish(viewer, qtbot, viewer.session.settle, LIGHT)
    return viewer


def middle(viewer, share: float = 0.75) -> QPoint:
    """Place in the record, within the bed."""
    plot = viewer.window.waterfall.plot_area
    return QPoint(plot.left() + int(share * plot.width()), plot.top() + plot.height() // 3)


def colour(viewer, share: float = 0.75) -> int:
    return int(viewer.window.waterfall.grab().toImage().pixel(middle(viewer, share)) & 0xFF00)


def test_a_kept_record_stays_while_the_scene_changes_and_is_shown_by_a_key_and_beside_it(compared, qtbot):
    kept = compared.comparison.kept
    assert kept.scene == edit(compared.session.scene, DARK)
    np.testing.assert_allclose(kept.record.amplitude * 2.0, compared.record.amplitude, rtol=1e-5)
    assert compared.comparison.changes == [("material diffuse", "0.2", "0.4")]
    assert compared.comparison.titles == ("material diffuse 0.2", "material diffuse 0.4")
    # Amplitudes twice as high are four times the energy.
    found = "changes the record by 300 %, 100 % of its picture visibly, its mean level by +6 dB"
    assert compared.comparison.difference == found
    assert compared.window.status.sentence.text() == f"material diffuse 0.2 → 0.4: {found}"
    shown = compared.panels["comparison"].view.changes.text()
    assert "0.2 → 0.4" in shown
    assert "+6 dB" in shown
    # A key shows it wherever the keyboard is but where text is typed.
    window = compared.window
    activate(window, qtbot)
    window.open_panel("lessons")
    bright = colour(compared)
    kinds = (QComboBox, QListWidget, QTabBar, QAbstractSlider, QAbstractButton)
    widgets = (compared.seabed.view.canvas.widget, window.waterfall, *(in_view(window, kind) for kind in kinds))
    for widget in widgets:
        chosen = widget.currentIndex() if isinstance(widget, (QComboBox, QListWidget)) else None
        widget.setFocus()
        assert QApplication.focusWidget() is widget
        QTest.keyPress(widget, Qt.Key.Key_X)
        assert colour(compared) < bright
        QTest.keyRelease(widget, Qt.Key.Key_X)
        assert colour(compared) == bright
        assert chosen is None or widget.currentIndex() == chosen, "it is no letter of an entry"
    # It is let go where the keyboard went.
    combo = in_view(window, QComboBox)
    combo.setFocus()
    QTest.keyPress(combo, Qt.Key.Key_X)
    window.findChild(QLineEdit, "search").setFocus()
    assert colour(compared) < bright
    QTest.keyRelease(QApplication.focusWidget(), Qt.Key.Key_X, Qt.KeyboardModifier.ShiftModifier)
    assert colour(compared) == bright
    for name in ("search", "value"):
        line = next(line for line in window.findChildren(QLineEdit, name) if line.isVisible())
        line.setFocus()
        QTest.keyPress(line, Qt.Key.Key_X)
        assert colour(compared) == bright
        QTest.keyRelease(line, Qt.Key.Key_X)
        assert "x" in line.text()
        line.undo()
    # Both are named where they stand side by side.
    views = window.record_a, window.waterfall
    assert [view.title for view in views] == ["", ""]
    compared.comparison.arrange(Arrangement.BESIDE)
    assert [view.title for view in views] == ["A  material diffuse 0.2", "B  material diffuse 0.4"]
    compared.session.settle({"seabed.material.diffuse": 0.5})
    assert views[1].title == "B  material diffuse 0.5"
    compared.comparison.arrange(Arrangement.ALONE)
    assert [view.title for view in views] == ["", ""]
    # It has the display of B.
    window.gain.setValue(60)
    qtbot.waitUntil(lambda: window.record_a.levels == window.waterfall.levels)
    choose(window.palettes, "grey")
    compared.session.show(ground_range=True, side="starboard")
    one, other = window.record_a.tone_map, window.waterfall.tone_map
    assert one.ends == other.ends
    np.testing.assert_array_equal(one.table, other.table)
    window.waterfall.grab()
    assert window.record_a.projection.axis == window.waterfall.projection.axis


def in_view(window, kind):
    """A widget of a kind that is shown and takes the keyboard."""
    shown = (child for child in window.findChildren(kind) if child.isVisible() and child.isEnabled())
    return next(child for child in shown if child.focusPolicy() != Qt.FocusPolicy.NoFocus)


def test_a_lies_pixel_for_pixel_over_b_and_follows_its_pings_a_tow_that_runs_and_another_scene(compared, small, qtbot):
    kept = compared.comparison.kept
    compared.session.undo()
    view, overlay = compared.window.waterfall, compared.window.overlay
    view.magnify(1.6)
    usual = {"ground_range": False, "newest_on_top": True, "side": "both"}
    for options in ({}, {"ground_range": True}, {"newest_on_top": False}, {"side": "starboard"}):
        compared.session.show(**(usual | options))
        qtbot.waitUntil(lambda: compared.complete)
        compared.find_levels()
        compared.comparison.tick(0.0)
        overlay.hide()
        plot = view.plot_area.adjusted(2, 2, -12, -30)  # without bar and caption
        live = colours_of(view.grab(plot).toImage())
        overlay.show()
        QTest.keyPress(compared.window, Qt.Key.Key_X)
        np.testing.assert_array_equal(colours_of(view.grab(plot).toImage()), live)  # the record of the same scene
        assert compared.window.record_a.mark_at(middle(compared)) == view.mark_at(middle(compared))
        QTest.keyRelease(compared.window, Qt.Key.Key_X)
    # A follows the pings of B.
    compared.session.show(**usual)
    compared.session.settle(LIGHT)
    compared.tow.speed = 4.0
    compared.tow.restart(1000)  # past the targets, before which the tow would pause
    compared.run(True)
    qtbot.waitUntil(lambda: view.top > 1060)
    finish(compared, qtbot, compared.run, False)
    assert compared.window.record_a.top == view.top
    np.testing.assert_allclose(kept.record.amplitude * 2.0, compared.record.amplitude, rtol=1e-5)
    finish(compared, qtbot, compared.go_to, 400)
    assert compared.window.record_a.top == view.top == 400
    np.testing.assert_array_equal(np.sort(kept.record.ping), np.sort(compared.record.ping))
    np.testing.assert_allclose(kept.record.amplitude * 2.0, compared.record.amplitude, rtol=1e-5)
    # Another scene with other bins stands beside it.
    finish(compared, qtbot, compared.open, edit(small, {"sonar.bins": 160, "sonar.range": 40.0, "track.pings": 64}))
    assert "not measured, because A has 100 bins of 50 m" in compared.comparison.difference
    assert overlay.place_of_a().width() / view.plot_area.width() == pytest.approx(50.0 / 40.0)
    compared.comparison.arrange(Arrangement.BESIDE)
    assert compared.window.record_a.isVisible()
    assert view.isVisible()
    compared.comparison.arrange(Arrangement.DIFFERENCE)
    assert not compared.window.record_a.isVisible()
    view.grab()
    assert overlay.difference.pixels.shape[0] == 64


def test_a_lies_left_of_a_line_that_is_dragged_is_drawn_as_a_difference_or_linked_beside_b(compared, qtbot):
    window, overlay = compared.window, compared.window.overlay
    bright = colour(compared)
    press_shortcut(compared.window, "W")
    assert compared.comparison.arrangement is Arrangement.WIPED
    assert colour(compared) == bright
    assert colour(compared, 0.25) < bright
    clicked = []
    window.waterfall.clicked.connect(clicked.append)
    QTest.mouseClick(overlay, Qt.MouseButton.LeftButton, pos=middle(compared, 0.25))
    assert clicked == [], "a pixel of A is not one of B"
    QTest.mouseClick(overlay, Qt.MouseButton.LeftButton, pos=middle(compared))
    assert clicked == [window.waterfall.mark_at(middle(compared))]
    plot = window.waterfall.plot_area
    line = QPoint(overlay.split, plot.center().y())
    drag(overlay, line, QPoint(plot.left() + int(0.9 * plot.width()), line.y()))
    assert overlay.split == pytest.approx(plot.left() + 0.9 * plot.width(), abs=2)
    assert colour(compared) < bright
    assert overlay.covers(middle(compared))
    press_shortcut(compared.window, "W")
    assert compared.comparison.arrangement is Arrangement.ALONE
    assert not overlay.covers(middle(compared))
    press_shortcut(compared.window, "D")
    before = window.waterfall.grab().toImage()
    picture = overlay.difference
    assert picture.span == 12.0  # 6.02 dB, and a little less near the floor
    held = picture.pixels[:, picture.pixels.shape[1] // 4]
    assert len(set(held.tolist())) == 1, "every ping is as much louder"
    finish(compared, qtbot, compared.session.undo)
    assert window.waterfall.grab().toImage() != before
    assert overlay.difference.span == SPANS[0], "both are the same"
    # Linked records zoom, scroll and point together until the padlock parts them.
    finish(compared, qtbot, compared.session.settle, LIGHT)
    links = compared.comparison.links
    live, beside = window.waterfall, window.record_a
    compared.comparison.arrange(Arrangement.BESIDE)
    qtbot.waitUntil(beside.isVisible)
    beside.magnify(2.0)
    assert live.zoom == beside.zoom != Zoom()
    live.magnify(1.5)
    assert live.zoom == beside.zoom
    mark = live.mark_at(live.plot_area.center())
    assert links.find_place(live, beside, mark) == mark
    live.hovered.emit(mark)
    assert beside.marks.cross == mark
    beside.hovered.emit(mark)
    assert live.marks.cross == mark
    beside.clicked.emit(mark)
    assert compared.inspection.mark == mark, "what is clicked in A is explained in B"
    top = live.top
    compared.go_to(100)
    beside.scrolled.emit(10)
    assert live.top == beside.top == 90 != top
    links.padlock.click()
    beside.show_zoom(Zoom())
    assert live.zoom != Zoom()
    live.hovered.emit(None)
    assert beside.marks.cross == mark
    # A returns with its modelling.
    shown = compared.session.scene
    compared.session.model(Modelling(0.1))
    press_shortcut(compared.window, "Shift+K")
    assert (compared.session.scene, compared.session.modelling) == (compared.comparison.kept.scene, Modelling())
    compared.session.undo()
    assert (compared.session.scene, compared.session.modelling) == (shown, Modelling(0.1))


def test_keys_without_a_or_a_partner_say_so_until_a_scene_is_traced_as_a_or_the_panel_keeps_one(viewer, small, qtbot):
    for key in ("W", "D", "Shift+K"):
        press_shortcut(viewer.window, key)
        assert "press K" in viewer.window.status.sentence.text()
    before = viewer.window.waterfall.grab().toImage()
    QTest.keyPress(viewer.window, Qt.Key.Key_X)
    assert viewer.window.waterfall.grab().toImage() == before
    QTest.keyRelease(viewer.window, Qt.Key.Key_X)
    press_shortcut(viewer.window, "P")
    assert "not one of a pair" in viewer.window.status.sentence.text()
    viewer.session.open(edit(small, {"partner": ["no-such-scene"]}))
    press_shortcut(viewer.window, "P")
    assert "no-such-scene" in viewer.window.status.sentence.text()
    assert viewer.comparison.a is None
    viewer.session.open(edit(small, LIGHT))
    finish(viewer, qtbot, viewer.comparison.keep_scene, edit(small, DARK))
    np.testing.assert_allclose(viewer.comparison.kept.record.amplitude * 2.0, viewer.record.amplitude, rtol=1e-5)
    viewer.comparison.keep_scene(edit(small, {"seed": 666}))
    qtbot.waitUntil(lambda: "666 is refused" in viewer.window.status.sentence.text())
    assert viewer.comparison.a is None
    # The panel keeps, arranges and leaves.
    finish(viewer, qtbot, viewer.open, small)
    viewer.window.open_panel("comparison")
    panel = viewer.panels["comparison"].view
    QTest.mouseClick(panel.keep, Qt.MouseButton.LeftButton)
    assert panel.title.text() == f"A: {small.title}"
    assert panel.changes.text() == "B equals A"
    assert not panel.learn.isVisible()
    for index, arrangement in enumerate(Arrangement):
        choose(panel.arrangement, index)
        assert viewer.comparison.arrangement is arrangement
    finish(viewer, qtbot, viewer.session.settle, LIGHT)
    QTest.mouseClick(panel.back, Qt.MouseButton.LeftButton)
    assert viewer.session.scene == small
    QTest.mouseClick(panel.leave, Qt.MouseButton.LeftButton)
    assert viewer.comparison.a is None
    assert viewer.window.record_a.record.pings == 1, "its memory is free"
    assert not viewer.window.overlay.isVisible()
    assert panel.title.text().startswith("Compare two records")


def test_one_action_opens_a_pair_of_those_that_are_read_before_their_menu_opens(open_viewer, small, qtbot):
    find_pairs.cache_clear()
    viewer = open_viewer(small)
    panel = viewer.panels["comparison"].view
    assert not panel.pairs_menu.actions()
    bring_to_front(viewer.window, "comparison")
    qtbot.waitUntil(lambda: bool(panel.pairs_menu.actions()))
    viewer.panels["comparison"].opened(True)
    panel.pairs_menu.aboutToShow.emit()
    actions = {action.data(): action for action in panel.pairs_menu.actions()}
    assert sorted(actions) == ["figure-2b", "figure-4b", "figure-5-relief", "ghosts"]
    assert len(panel.pairs_menu.actions()) == 4
    assert not panel.partner.isEnabled()
    for name, action in actions.items():
        action.trigger()
        qtbot.waitUntil(lambda: viewer.complete and bool(viewer.comparison.difference), timeout=120000)
        assert viewer.session.scene == load_scene(name)
        assert viewer.comparison.kept.scene == load_partner(load_scene(name))
        assert not viewer.comparison.kept.record.missing(viewer.window.waterfall.top, 0).size
        assert viewer.comparison.changes
        assert panel.partner.isEnabled()


def test_a_pair_is_drawn_by_a_command(tmp_path):
    path = tmp_path / "pair.png"
    small = ["--set", "track.pings=64", "--set", "sonar.bins=80"]
    assert main(["view", "figure-4b", *small, "--pair", "difference", "--snapshot", str(path)]) == 0
    with Image.open(path) as picture:
        assert picture.width > 800
    assert main(["view", "default", "--pair", "--snapshot", str(path)]) == 2
