"""Scene, record and picture in files, and the question before changes are lost."""

import numpy as np
import pytest
from controls import answer_questions, finish
from PIL import Image
from PySide6.QtWidgets import QFileDialog, QMessageBox

from insonify import simulate
from insonify.io.records import RECORDS, read_record
from insonify.scene import bundled_scenes, edit, load_scene
from insonify_viewer.widgets.save_dialogs import save_picture

Buttons = QMessageBox.StandardButton


@pytest.fixture
def name(monkeypatch):
    """Name the file that the next dialogs return, and the filter that is picked in them."""

    def set_name(path, picked=""):
        monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), picked))

    return set_name


def test_a_saved_scene_is_the_scene_and_is_saved_again_where_it_is(viewer, tmp_path, name, monkeypatch):
    viewer.session.settle({"track.altitude": 7.0})
    assert viewer.window.isWindowModified()
    for typed, written in (("saved.toml", "saved.toml"), ("my.scene", "my.scene.toml")):
        name(tmp_path / typed, "Scenes (*.toml)")
        viewer.window.save.scene_as.trigger()
        assert load_scene(tmp_path / written) == viewer.session.scene
        assert not viewer.window.isWindowModified()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["my.scene.toml", "saved.toml"]
    viewer.session.undo()
    assert not viewer.window.isWindowModified(), "the scene as it was opened"
    viewer.session.settle({"track.altitude": 8.0})
    assert viewer.window.isWindowModified()
    # A scene without a file is asked for one, and saved there from then on.
    viewer.open(edit(viewer.session.scene, {"seed": 5}))
    assert viewer.session.unsaved
    file = tmp_path / "mine.toml"
    name(file)
    viewer.window.save.scene.trigger()
    assert "mine.toml" in viewer.window.windowTitle()
    assert viewer.window.settings.recent[0] == str(file.resolve())
    name(tmp_path / "never.toml")
    viewer.session.settle({"track.altitude": 6.0})
    viewer.window.save.scene.trigger()
    assert load_scene(file).track.altitude == 6.0
    viewer.session.undo()
    assert viewer.session.unsaved, "the file holds the later scene"
    file.write_text("# why it is so low\n" + file.read_text())
    name("")  # the person leaves the dialog
    viewer.session.settle({"track.altitude": 5.0})
    viewer.window.save.scene.trigger()
    assert file.read_text().startswith("# why"), "comments are not lost without a question"
    assert viewer.session.unsaved
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.toml", "my.scene.toml", "saved.toml"]
    # One that cannot be written stays unsaved, and the picture is a file of its own.
    name(tmp_path / "nowhere" / "saved.toml")
    viewer.window.save.scene.trigger()
    assert "check that the folder can be written to" in viewer.window.status.sentence.text()
    assert viewer.session.unsaved
    with pytest.raises(OSError, match="No such file"):
        save_picture(viewer.window, tmp_path / "nowhere" / "window.png")
    written = tmp_path / "window.png"
    name(written)
    viewer.window.save.picture.trigger()
    with Image.open(written) as picture:
        shown = viewer.window.size() * viewer.window.devicePixelRatioF()
        assert picture.size == shown.toTuple()
    assert written.stat().st_size > 10_000
    assert {path.name for path in tmp_path.iterdir()} == {"mine.toml", "my.scene.toml", "saved.toml", "window.png"}
    asked = answer_questions(monkeypatch, Buttons.Discard)
    assert viewer.window.close(), "changes are discarded"
    assert len(asked) == 1


def test_a_record_is_written_as_the_command_writes_it(open_viewer, small, qtbot, tmp_path, name, monkeypatch):
    assert set(RECORDS.writable()) >= {".nc", ".npz", ".xtf", ".jsf"}
    viewer = open_viewer(edit(small, {"sonar.beam": "knife"}))
    for recording in ("record.xtf", "record.jsf"):
        name(tmp_path / recording)
        check_written(viewer, tmp_path / recording, qtbot)
    # A name without a suffix takes that of the format.
    npz = next(each for each in RECORDS.formats() if ".npz" in each.suffixes)
    name(tmp_path / "record", f"{npz.description} (*.npz)")
    check_written(viewer, tmp_path / "record.npz", qtbot)
    before = (tmp_path / "record.npz").stat().st_mtime_ns
    asked = answer_questions(monkeypatch, Buttons.No)
    viewer.window.save.record.trigger()
    assert asked == ["record.npz exists already. Replace it?"]
    assert not viewer.jobs.running
    assert (tmp_path / "record.npz").stat().st_mtime_ns == before
    assert viewer.window.close()
    assert len(asked) == 1, "without changes it closes at once"


def check_written(viewer, path, qtbot):
    """Check the record that a job of the window writes to a path."""
    scene = viewer.session.scene
    viewer.window.save.record.trigger()
    assert viewer.window.jobs.isVisible()
    qtbot.waitUntil(lambda: not viewer.jobs.running, timeout=240000)
    assert viewer.window.status.sentence.text() == f"{path}: {scene.track.pings} pings of 2 x {scene.sonar.bins} bins"
    assert not viewer.window.jobs.isVisible()
    record = read_record(path)
    assert record.sizes["ping_time"] == scene.track.pings
    if path.suffix not in (".xtf", ".jsf"):  # which keep fewer digits
        np.testing.assert_array_equal(record.intensity, simulate(scene).intensity)


def test_opening_a_scene_by_its_picture_and_closing_ask_about_changes(
    viewer, small, qtbot, tmp_path, name, monkeypatch
):
    (tmp_path / "bad.toml").write_text("[sonar]\nrang = 3\n")
    viewer.files.open_scene(str(tmp_path / "bad.toml"))
    assert "did you mean 'range'" in viewer.window.status.sentence.text()
    assert viewer.session.scene == small
    wanted, other = load_scene("figure-4b"), str(bundled_scenes()["figure-4b"])
    viewer.session.settle({"track.altitude": 7.0})
    changed = viewer.session.scene
    answers = Buttons.Cancel, Buttons.Discard, Buttons.Cancel, Buttons.Save
    asked = answer_questions(monkeypatch, *answers)
    viewer.window.scenes.wanted.emit(other)
    assert viewer.session.scene == changed
    viewer.window.scenes.wanted.emit(other)
    assert viewer.session.scene == wanted
    assert viewer.panels["parameters"].view.about.words == wanted.about
    assert not viewer.window.isWindowModified()
    assert len(asked) == 2
    finish(viewer, qtbot, viewer.session.undo)
    assert viewer.window.isWindowModified(), "the changes are there again"
    # So does closing.
    assert not viewer.window.close()
    assert viewer.window.isVisible()
    assert len(asked) == 3
    assert small.title in asked[2]
    name("")  # the dialog is left
    assert not viewer.window.close()
    name(tmp_path / "kept.toml")
    assert viewer.window.close()
    assert load_scene(tmp_path / "kept.toml").track.altitude == 7.0
    assert len(asked) == 5
