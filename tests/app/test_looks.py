"""Both themes can be read, change while the window is open, and are kept."""

from unittest.mock import Mock

import numpy as np
import pytest
from controls import choose, colours_of, finish, watched_events
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPalette
from PySide6.QtWidgets import QWidget

from insonify.display.display_options import DisplayOptions
from insonify.scene import scene_to_toml
from insonify_viewer.application import keep_display, keep_place
from insonify_viewer.panels.parameters.view.parameters_view import AboutBox
from insonify_viewer.panels.record.view import HistogramView
from insonify_viewer.widgets import buttons as icons
from insonify_viewer.widgets.buttons import make_icon
from insonify_viewer.widgets.painting import draw_pin
from insonify_viewer.widgets.theme import ACCENT, COLOURS, GROUND, MARK_IN_WATER, Theme, apply_theme
from insonify_viewer.window.settings import Settings


def contrast(one: str, other: str) -> float:
    """Contrast ratio of two colours (WCAG 2.1, section 1.4.3)."""
    shares = np.array([QColor(name).getRgbF()[:3] for name in (one, other)])
    linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    dark, light = np.sort(linear @ (0.2126, 0.7152, 0.0722))  # luminances
    return float((light + 0.05) / (dark + 0.05))


@pytest.mark.parametrize("light", [False, True], ids=["dark", "light"])
def test_words_stand_out(light):
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0), "as WCAG gives it"
    for words, *grounds in (
        ("TEXT", "GROUND", "RAISED", "EDGE"), ("QUIET", "GROUND", "RAISED"), ("ACCENT", "GROUND", "RAISED"),
        ("MARK", "GROUND"), ("GROUND", "ACCENT"),
    ):  # fmt: skip
        for ground in grounds:
            assert contrast(COLOURS[words][light], COLOURS[ground][light]) >= 4.5, (words, ground)


def test_the_theme_changes_in_the_open_window(viewer, qtbot, qapp):
    window, words = viewer.window, viewer.panels["parameters"].widget.findChild(AboutBox).label
    finish(viewer, qtbot, window.open_panel, "water")
    water = viewer.panels["water"].view
    themes = {action.data(): action for action in window.looks.themes}
    for theme, column in ((Theme.LIGHT, 1), (Theme.DARK, 0)):
        themes[theme].trigger()
        ground = COLOURS["GROUND"][column]
        assert Settings().theme is theme
        assert GROUND.name() == ground
        assert qapp.palette().color(QPalette.ColorRole.Window).name() == ground
        # A native window may have 16 bits a pixel: 5 of them for red.
        corner = window.waterfall.grab().toImage().pixelColor(1, 1)
        assert corner.lightness() == pytest.approx(QColor(ground).lightness(), abs=8)
        assert ACCENT.name() in words.text(), "so do the links of a description"
        picture = colours_of(water.grab().toImage())  # angles over the water stand on the ground of the window
        above = np.unique(picture[2:20, water.width() // 2 :])
        assert max(contrast(f"#{colour:06x}", ground) for colour in above) >= 4.5
    assert window.looks.themes[1].isChecked()


def test_a_change_of_theme_styles_each_widget_twice_at_most(qtbot, qapp):
    widgets = [QWidget()]
    qtbot.addWidget(widgets[0])
    for _ in range(9):
        widgets.append(QWidget(widgets[-1]))
    widgets[0].show()
    with watched_events(qapp, QEvent.Type.StyleChange) as changed:
        apply_theme(qapp, Theme.LIGHT)
    assert all(1 <= changed.count(widget) <= 2 for widget in widgets), "not once for each of its ancestors"


def test_an_icon_is_drawn_once_in_a_colour(qapp, monkeypatch):
    first = make_icon("play").pixmap(20).toImage()
    monkeypatch.setattr(icons, "resources", Mock(side_effect=AssertionError("it was read before")))
    assert make_icon("play").pixmap(20).toImage() == first
    assert not first.isNull()


def test_settings_survive_nonsense_and_a_gain_that_is_dragged_writes_no_file(monkeypatch):
    settings = Settings()
    assert (settings.theme, settings.size, settings.recent) == (Theme.SYSTEM, 100, [])
    for name, value in (("theme", "pink"), ("size", "-3"), ("recent", 7), ("geometry", "wide")):
        settings.store.setValue(name, value)
    assert (settings.theme, settings.size) == (Theme.SYSTEM, 100)
    assert settings.geometry.isEmpty()
    assert isinstance(settings.recent, list)
    for spoilt in ("palette=none-such", 7, ["range_lines=3"], "levels=[0, 1]", "pings"):
        settings.store.setValue("display", spoilt)
        assert Settings().display == {}, "the usual one"
    settings.size, settings.theme = 150, Theme.LIGHT
    assert (Settings().size, Settings().theme) == (150, Theme.LIGHT)
    monkeypatch.setattr(settings.store, "setValue", Mock())
    for gain in (1.0, 2.0, 3.0):
        settings.keep_display(DisplayOptions(gain=gain))
    settings.store.setValue.assert_not_called()


def test_place_of_the_window_and_display_of_the_record_are_kept_between_starts(open_viewer, small, qtbot):
    first = open_viewer(small)
    keep_place(first)
    keep_display(first)
    first.window.resize(1000, 620)
    qtbot.waitUntil(lambda: first.window.width() == 1000)
    view = first.panels["record"].view
    first.window.open_panel("record")
    for name in ("newest_on_top", "water_column", "decibels"):
        view.ticks[name].click()
    choose(first.window.palettes, "grey")
    first.session.show(gain=6.0, levels=(0.1, 4.0))
    first.window.close()
    second = open_viewer(small)
    keep_place(second)
    qtbot.waitUntil(lambda: (second.window.width(), second.window.height()) == (1000, 620))
    assert second.session.display == DisplayOptions(), "a snapshot shows the usual display"
    keep_display(second)
    kept = DisplayOptions(newest_on_top=False, water_column=False, decibels=True, palette="grey")
    assert second.session.display == kept, "without the gain and contrast of one record"
    assert second.window.palettes.currentText() == "grey"
    assert "display" not in scene_to_toml(second.session.scene)
    second.session.show(gain=6.0, levels=(0.1, 4.0))
    second.window.open_panel("record")
    qtbot.mouseClick(second.panels["record"].view.usual, Qt.MouseButton.LeftButton)
    assert second.session.display == DisplayOptions()
    assert Settings().display == {}
    (entry,) = [action for action in second.window.menus.record.actions() if action.text() == "Usual display"]
    second.session.show(range_lines=True)
    assert Settings().display == {"range_lines": True}
    entry.trigger()
    assert Settings().display == {}


@pytest.mark.parametrize("theme", [Theme.DARK, Theme.LIGHT])
def test_a_histogram_and_marks_of_a_record_stand_out_from_their_halos(theme, qtbot, qapp):
    apply_theme(qapp, theme)
    histogram = HistogramView()
    qtbot.addWidget(histogram)
    histogram.resize(320, 112)
    histogram.show()
    histogram.show_levels(lambda: np.zeros(1000, dtype=np.float32))
    qtbot.waitUntil(lambda: len(histogram.canvas.listDataItems()) > 0)
    qtbot.wait(20)
    picture, places = histogram.grab().toImage(), [histogram.place_of(level, 0.3) for level in (0.25, 30.0)]
    peak, beside = (picture.pixelColor(place).name() for place in places)
    assert contrast(peak, beside) >= 3.0
    picture = QImage(60, 60, QImage.Format.Format_RGB32)
    for echo in ("#000000", "#b06a28", "#ffffff"):
        picture.fill(QColor(echo))
        with QPainter(picture) as painter:
            draw_pin(painter, QPoint(30, 30))
        drawn = {f"#{colour:06x}" for colour in np.unique(colours_of(picture))}
        assert max(contrast(one, echo) for one in drawn) >= 3.0
        assert max(contrast(MARK_IN_WATER, one) for one in drawn) >= 3.0, "against the echo or the halo"
