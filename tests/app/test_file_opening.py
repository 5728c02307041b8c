"""Files of every kind dropped on the window, and the list of recent files."""

import shutil

import numpy as np
import pytest
from controls import drop
from PySide6.QtWidgets import QFileDialog, QMessageBox

from insonify.io.contacts import Contact, write_contacts
from insonify.scene import bundled_meshes, bundled_scenes, edit, scene_to_toml
from insonify_viewer.window.settings import RECENT, Settings


def said(viewer) -> str:
    return str(viewer.window.status.sentence.text())


def open_again(viewer, name: str):
    """Open a file by its entry in the list of recent ones."""
    menu = viewer.window.recent
    menu.fill()
    next(action for action in menu.actions() if action.text() == name).trigger()


def test_a_mesh_is_dropped_and_opened_again(open_viewer, small, qtbot, tmp_path):
    path = tmp_path / bundled_meshes()["drum"].name
    shutil.copy(bundled_meshes()["drum"], path)
    viewer = open_viewer(small)
    drop(viewer.window, bundled_meshes()["drum"])
    qtbot.waitUntil(lambda: len(viewer.session.scene.targets) == len(small.targets) + 1)
    assert Settings().recent == [], "one that comes with the program is not among them"
    viewer.session.undo()
    drop(viewer.window, path)
    qtbot.waitUntil(lambda: len(viewer.session.scene.targets) == len(small.targets) + 1)
    target = viewer.session.scene.targets[-1]
    assert (target.kind, target.path) == ("mesh", str(path))
    x, y = target.position[:2]
    assert said(viewer) == f"mesh {path.name} added as target {len(small.targets) + 1}, at x {x:g} m, y {y:g} m"
    open_again(viewer, path.name)
    qtbot.waitUntil(lambda: len(viewer.session.scene.targets) == len(small.targets) + 2)


@pytest.fixture
def bed(tmp_path):
    path = tmp_path / "bed.npy"
    np.save(path, -20.0 + np.random.default_rng(1).normal(0.0, 0.1, (300, 300)))
    return path


def test_a_bed_is_dropped_opened_again_and_asks_about_changes(viewer, small, qtbot, bed, monkeypatch):
    for attempt in (drop, lambda window, _: open_again(viewer, "bed.npy")):
        attempt(viewer.window, bed)
        qtbot.waitUntil(lambda: viewer.session.scene.seabed.relief.kind == "dem")
        assert said(viewer).endswith("the 3 targets were removed with the scene before (Undo restores it)")
        assert Settings().recent == [str(bed)]
        viewer.session.undo()
        assert viewer.session.scene == small
    # It asks about unsaved changes.
    asked, answer = [], {0: QMessageBox.StandardButton.Cancel}  # at first
    discard = QMessageBox.StandardButton.Discard
    monkeypatch.setattr(QMessageBox, "question", lambda *words: (asked.append(words[2]), answer.pop(0, discard))[1])
    viewer.session.settle({"track.altitude": 7.0})
    changed = viewer.session.scene
    drop(viewer.window, bed)
    qtbot.wait(100)
    assert viewer.session.scene is changed
    assert not said(viewer).startswith("reading")
    drop(viewer.window, bed)
    qtbot.waitUntil(lambda: viewer.session.scene.seabed.relief.kind == "dem")
    assert asked == [f"The scene “{small.title}” has changes that are not saved."] * 2


@pytest.fixture
def cast(tmp_path):
    path = tmp_path / "cast.csv"
    path.write_text("depth,sound_speed\n0,1500\n10,1495\n40,1490\n", encoding="utf-8")
    return path


@pytest.fixture
def tow(tmp_path):
    path = tmp_path / "tow.csv"
    path.write_text("time,x,y,heading\n" + "".join(f"{t},{2 * t},0,0\n" for t in range(31)), encoding="utf-8")
    return path


def test_a_cast_and_navigation_are_dropped_and_opened_again(open_viewer, small, qtbot, cast, tow):
    viewer = open_viewer(edit(small, {"water.absorption": 12.0, "sonar.ping_rate": 15.0}))
    for attempt in (drop, lambda window, _: open_again(viewer, "cast.csv")):
        attempt(viewer.window, cast)
        qtbot.waitUntil(lambda: viewer.session.scene.water.kind == "cast")
        assert viewer.session.scene.water.absorption.coefficient == 12.0, "the rest of the water stays"
        assert said(viewer).startswith("sound speed of cast.csv: 3 depths, down to 40 m; ping rate lowered to")
        assert viewer.window.undo.text() == "Undo: sound speed of cast.csv"
        assert Settings().recent == [str(cast)]
        viewer.session.undo()
        assert viewer.session.scene.water.kind == "uniform"
    before = viewer.session.scene
    for attempt in (drop, lambda window, _: open_again(viewer, "tow.csv")):
        attempt(viewer.window, tow)
        qtbot.waitUntil(lambda: viewer.session.scene.track.motion.kind == "recorded")
        assert viewer.session.scene.track.motion.path == str(tow)
        assert said(viewer) == "navigation of tow.csv: x, y, heading at 31 times, 30 s in all"
        assert viewer.window.undo.text() == "Undo: navigation of tow.csv"
        assert Settings().recent == [str(tow), str(cast)]
        viewer.session.undo()
        assert viewer.session.scene == before


@pytest.mark.parametrize("suffix", [".geojson", ".csv"])
def test_contacts_are_dropped_and_opened_by_menu(open_viewer, small, tmp_path, suffix, monkeypatch):
    path = tmp_path / f"found{suffix}"
    write_contacts(path, [Contact(name, "", "line.xtf", 3, "port", 12, 2.5) for name in ("wreck", "rock")])
    viewer = open_viewer(small)
    drop(viewer.window, path)
    assert [each.name for each in viewer.contacts.all] == ["wreck", "rock"]
    assert said(viewer) == f"2 contacts of found{suffix}"
    assert viewer.window.undo.text() == f"Undo: open found{suffix}"
    viewer.window.undo.trigger()
    assert not viewer.contacts.all
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    next(action for action in viewer.window.menus.file.actions() if action.text() == "Open contacts…").trigger()
    assert len(viewer.contacts) == 2
    assert not viewer.window.isWindowModified()
    viewer.contacts.remove(0)
    assert viewer.window.isWindowModified()
    open_again(viewer, path.name)
    assert len(viewer.contacts) == 2


def test_a_file_is_refused_in_one_sentence_or_taken_over_by_a_field_and_among_recent_ones(
    viewer, small, qtbot, cast, tow, tmp_path, monkeypatch
):
    drop(viewer.window, cast, tow)
    assert said(viewer) == "2 files were dropped at once; drop one file at a time"
    (tmp_path / "letter.txt").write_text("x", encoding="utf-8")
    drop(viewer.window, tmp_path / "letter.txt")
    assert said(viewer).startswith("letter.txt: cannot be opened by its suffix; give a scene")
    (tmp_path / "sums.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    drop(viewer.window, tmp_path / "sums.csv")
    qtbot.waitUntil(lambda: "has no column time" in said(viewer))
    assert viewer.session.scene == small
    assert Settings().recent == []
    # One that a field takes over is among the recent ones.
    settle = viewer.panels["parameters"]._settle
    for path, kind, file in (("water.kind", "cast", cast), ("track.motion.kind", "recorded", tow)):
        monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, file=file: (str(file), ""))
        settle(path, kind)
    assert Settings().recent == [str(tow), str(cast)]
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(tow.with_name("none.csv")), ""))
    settle("track.motion.kind", "straight")
    settle("water.kind", "uniform")
    settle("water.kind", "cast")
    assert len(Settings().recent) == 2, "what is not there is not among them"


def test_recent_files_are_kept_and_vanished_ones_said_so(open_viewer, small, tmp_path):
    paths = [tmp_path / f"{name}.toml" for name in ("one", "two")]
    for number, path in enumerate(paths):
        path.write_text(scene_to_toml(edit(small, {"seed": number + 7})), encoding="utf-8")
    viewer = open_viewer(small)
    for path in paths:
        drop(viewer.window, path)
    menu = viewer.window.recent
    menu.fill()
    assert [action.text() for action in menu.actions()[:2]] == ["two.toml", "one.toml"]
    menu.actions()[1].trigger()
    assert viewer.session.scene.seed == 7
    paths[1].unlink()
    menu.fill()
    assert [action.text() for action in menu.actions()[:2]] == ["one.toml", "two.toml  (no longer there)"]
    menu.actions()[1].trigger()
    said = viewer.window.status.sentence.text()
    assert said.endswith("two.toml is no longer there; it was removed from the recent files")
    assert Settings().recent == [str(paths[0])]
    menu.fill()
    next(action for action in menu.actions() if action.text() == "Clear the list").trigger()
    assert Settings().recent == []
    # Bundled scenes are not among them.
    path = tmp_path / "other.toml"
    path.write_text(scene_to_toml(edit(small, {"track.altitude": 6.5})), encoding="utf-8")
    for name in ("default", "pipe-on-bed"):
        viewer.window.scenes.wanted.emit(str(bundled_scenes()[name]))
        assert Settings().recent == [], "one that comes with the program is not among them"
    drop(viewer.window, path)
    assert viewer.session.scene.track.altitude == 6.5
    assert viewer.session.file == str(path)


def test_the_list_has_an_end(tmp_path):
    settings = Settings()
    for number in range(RECENT + 5):
        settings.add_recent(str(tmp_path / f"{number}.toml"))
    assert len(Settings().recent) == RECENT
    assert Settings().recent[0].endswith(f"{RECENT + 4}.toml")
