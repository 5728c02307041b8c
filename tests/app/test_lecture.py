"""View for a lecture: what fills the screen, presets on keys, and the files that hold them."""

import re
from functools import partial
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QToolBar

from insonify.display.display_options import DisplayOptions
from insonify.scene import SceneError, edit, load_scene
from insonify_viewer.state.playlist import Preset, read_playlist, write_playlist


def test_a_lecture_shows_presets_by_keys_and_leaves_the_window_as_it_was(viewer, small, qtbot, tmp_path, monkeypatch):
    window, session = viewer.window, viewer.session
    window.open_panel("water")
    docks = [viewer.panels[name].widget for name in ("parameters", "water")]
    press = partial(qtbot.keyClick, window.waterfall)
    window.lecture.preset_kept.emit(1)
    session.settle({"track.altitude": 7.0})
    session.show(palette="grey")
    window.lecture.preset_kept.emit(2)
    sizes = window._splitter.sizes()

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
    qtbot.waitUntil(lambda: abs(window._splitter.sizes()[0] - sizes[0]) < 8)
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
