"""View for a lecture: what fills the screen, presets on keys, and the files that hold them."""

import re
from functools import partial
from itertools import pairwise
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtWidgets import QApplication, QToolBar, QWidget

from insonify.display.display_options import DisplayOptions
from insonify.scene import SceneError, bundled_scenes, edit, load_scene
from insonify_viewer.application import make_application
from insonify_viewer.panels.parameters.view.control_strip import ControlStrip
from insonify_viewer.state.playlist import Preset, read_playlist, write_playlist
from insonify_viewer.state.sections import alone, sections_of
from insonify_viewer.widgets.field_rows import NumberRow
from insonify_viewer.widgets.theme import lecture_scale


@pytest.fixture
def viewer(open_viewer, small):
    return open_viewer(small)  # without presets


def test_a_lecture_shows_presets_by_keys_and_leaves_the_window_as_it_was(viewer, small, qtbot, tmp_path, monkeypatch):
    window, session = viewer.window, viewer.session
    window.open_panel("water")
    docks = [viewer.panels[name].widget for name in ("parameters", "water")]
    press = partial(qtbot.keyClick, window.waterfall)
    window.lecture.preset_kept.emit(1)
    session.settle({"track.altitude": 7.0})
    session.show(palette="grey")
    window.lecture.preset_kept.emit(2)
    sizes = window.views.sizes()

    window.lecture.action.trigger()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)
    assert window.waterfall.isVisible()
    assert not any(dock.isVisible() for dock in docks)
    assert [bar.objectName() for bar in window.findChildren(QToolBar) if bar.isVisible()] == ["lecture"]
    assert not window.statusBar().isVisible()
    assert window.waterfall.width() >= 0.5 * window.width()
    press(Qt.Key.Key_1)
    assert (session.scene, session.display) == (small, DisplayOptions())
    press(Qt.Key.Key_2)
    assert (session.scene.track.altitude, session.display.palette) == (7.0, "grey")
    assert not viewer.saving.unsaved
    press(Qt.Key.Key_7)
    assert "no preset" in window.status.sentence.text()
    press(Qt.Key.Key_Period)
    assert window.lecture.blanked
    press(Qt.Key.Key_Escape)
    assert not window.lecture.blanked
    assert window.lecture.action.isChecked()
    slider = viewer.panels["parameters"].strip.rows["track.altitude"].slider
    slider.setValue(slider.value() + 50)
    assert session.scene.track.altitude > 7.0
    session.undo()

    press(Qt.Key.Key_Escape)
    assert not window.lecture.action.isChecked()
    assert QApplication.overrideCursor() is None
    qtbot.waitUntil(lambda: all(dock.isVisible() for dock in docks))
    qtbot.waitUntil(lambda: abs(window.views.sizes()[0] - sizes[0]) < 8)
    press(Qt.Key.Key_2)
    assert session.display.side == "port", "the keys have their usual meaning again"
    # Presets are opened and saved.
    file = tmp_path / "lecture.toml"
    file.write_text('[[preset]]\nscene = "ripples"\nset = { "track.altitude" = 4.0 }\ndisplay = ["side=\\"port\\""]\n')
    presets = viewer.presets
    presets.open(str(file))
    monkeypatch.setattr("insonify_viewer.window.presets.ask_where_to_save", lambda *_: tmp_path / "shared.toml")
    presets.save()
    found = read_playlist(tmp_path / "shared.toml")
    assert found == read_playlist(file)
    assert (found[1].scene.track.altitude, found[1].display.side) == (4.0, "port")
    assert window.settings.presets == str(tmp_path / "shared.toml"), "opened at the next start"
    file.write_text("[[preset]]\nscene = 3\n")
    presets.open(str(file))
    assert "lecture.toml: preset 1: scene = 3 is not valid" in window.status.sentence.text()


@pytest.mark.parametrize("percent", [100, 150, 200, 250])
def test_the_strip_shows_every_name_and_value_whole_on_every_screen(percent, qtbot):
    make_application()
    for name, path in bundled_scenes().items():
        scene = load_scene(path)
        rows = {field.path: alone(field) for section in sections_of(scene) for field in section.parameters}
        strip = ControlStrip(lambda *_: None, lambda *_: None)
        qtbot.addWidget(strip)
        font = strip.font()
        font.setPointSizeF(font.pointSizeF() * percent / 100)
        strip.setFont(font)
        strip.show()
        strip.show_fields([rows[path] for path in scene.controls if path in rows])
        for width in (1280, 1600, 1920, 2560, 3840):
            strip.resize(width, strip.height())
            strip.resize(width, strip.sizeHint().height())
            shown = [row for row in strip.rows.values() if row.label.isVisible()]
            assert len(shown) >= min(len(strip.rows), 2), (name, width)
            assert strip.sizeHint().height() <= 6 * strip.fontMetrics().height() * lecture_scale(strip) + 20
            for row in shown:
                for part in filter(QWidget.isVisible, row.parts):
                    inside = QRect(part.mapTo(strip, QPoint()), part.size())
                    assert strip.rect().contains(inside), (name, width, row.label.text())
                assert row.label.width() >= row.label.sizeHint().width(), (name, width, row.label.text())
                if isinstance(row, NumberRow):
                    text = row.field.fontMetrics().horizontalAdvance(row.field.text())
                    assert row.field.width() >= text + 8, (name, width, row.field.text())
        assert len(shown) == len(strip.rows), (name, "at the greatest width")


def test_presets_have_names_of_their_own_and_all_of_them_show(viewer):
    lecture = viewer.window.lecture
    for key in range(1, 10):
        lecture.preset_kept.emit(key)
    lecture.preset_named.emit(3, "Low & slow")
    lecture.action.trigger()
    buttons = [lecture.presets.itemAt(k).widget() for k in range(lecture.presets.count())]
    assert [button.accessibleName().partition("  ")[0] for button in buttons] == list("123456789")
    assert buttons[2].accessibleName() == "3  Low & slow"
    assert not any(a.geometry().intersects(b.geometry()) for a, b in pairwise(buttons))
    lecture.action.trigger()


def test_a_playlist_is_read_as_it_was_written(tmp_path):
    scene, look = edit(load_scene("default"), {"track.altitude": 6.0}), DisplayOptions(palette="grey", gain=3.0)
    presets = {3: Preset("Low", scene, look), 9: Preset("x", scene, DisplayOptions())}
    write_playlist(tmp_path / "a.toml", presets)
    assert read_playlist(tmp_path / "a.toml") == presets
    # The playlist of the documentation is one.
    page = (Path(__file__).parents[2] / "docs/howto/view.md").read_text(encoding="utf-8")
    (shown,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    (tmp_path / "a.toml").write_text(shown, encoding="utf-8")
    assert read_playlist(tmp_path / "a.toml")[1].scene.track.altitude == 5.0


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "has no .*preset"),
        ("[[preset]", "not valid TOML"),
        ('[[preset]]\nscene = "nowhere"', "preset 1: scene 'nowhere'"),
        ('[[preset]]\nkey = 12\nscene = "default"', "key 12 is not one of 1 to 9"),
        ('[[preset]]\nkey = 2\nscene = "default"\n[[preset]]\nscene = "wreck"', "preset 2: key 2 belongs to"),
        ('[[preset]]\nscene = "default"\ncolour = 1', "colour is not a field"),
        ('[[preset]]\nscene = "default"\nset = { "track.altitude" = -1.0 }', "altitude"),
    ],
)
def test_a_faulty_playlist_is_refused_in_one_sentence(text, fault, tmp_path):
    path = tmp_path / "a.toml"
    path.write_text(text)
    with pytest.raises(SceneError, match=fault):
        read_playlist(path)
