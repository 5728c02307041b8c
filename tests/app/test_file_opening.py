"""Files of every kind dropped on the window, and the list of recent files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QMessageBox

from insonify.scene import Scene, bundled_meshes, bundled_scenes, edit, scene_to_toml
from insonify_viewer.views.settings import RECENT, Settings


def drop(window: Any, *paths: Path) -> None:
    data = QMimeData()
    data.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    buttons, none = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(300, 300), Qt.DropAction.CopyAction, data, buttons, none)
    QApplication.sendEvent(window, enter)
    assert enter.isAccepted()
    QApplication.sendEvent(window, QDropEvent(QPointF(300, 300), Qt.DropAction.CopyAction, data, buttons, none))


def said(viewer: Any) -> str:
    return str(viewer.window.status.sentence.text())


@pytest.fixture
def bed(tmp_path: Path) -> Path:
    path = tmp_path / "bed.npy"
    np.save(path, -20.0 + np.random.default_rng(1).normal(0.0, 0.1, (300, 300)))
    return path


def test_a_bed_asks_about_unsaved_changes(
    open_viewer: Any, small: Scene, qtbot: Any, bed: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, answer = [], {0: QMessageBox.StandardButton.Cancel}  # at first
    discard = QMessageBox.StandardButton.Discard
    monkeypatch.setattr(QMessageBox, "question", lambda *words: (asked.append(words[2]), answer.pop(0, discard))[1])
    viewer = open_viewer(small)
    viewer.session.settle({"track.altitude": 7.0})
    changed = viewer.session.scene
    drop(viewer.window, bed)
    qtbot.wait(100)
    assert viewer.session.scene is changed
    assert not said(viewer).startswith("reading")
    drop(viewer.window, bed)
    qtbot.waitUntil(lambda: viewer.session.scene.seabed.relief.kind == "dem", timeout=20000)
    assert asked == [f"The scene “{small.title}” has changes that are not saved."] * 2


def test_several_files_at_once_are_refused_in_one_sentence(open_viewer: Any, small: Scene, bed: Path) -> None:
    viewer = open_viewer(small)
    drop(viewer.window, bed, bed)
    assert said(viewer) == "2 files were dropped at once; drop one file at a time"
    assert viewer.session.scene == small


def test_a_scene_is_dropped(open_viewer: Any, small: Scene, tmp_path: Path) -> None:
    path = tmp_path / "other.toml"
    path.write_text(scene_to_toml(edit(small, {"track.altitude": 6.5})), encoding="utf-8")
    viewer = open_viewer(small)
    drop(viewer.window, path)
    assert viewer.session.scene.track.altitude == 6.5
    assert viewer.session.file == str(path)


def test_a_mesh_is_dropped(open_viewer: Any, small: Scene, qtbot: Any) -> None:
    viewer = open_viewer(small)
    drop(viewer.window, bundled_meshes()["drum"])
    qtbot.waitUntil(lambda: len(viewer.session.scene.targets) == len(small.targets) + 1, timeout=20000)
    assert viewer.session.scene.targets[-1].kind == "mesh"


def test_a_bed_is_dropped(open_viewer: Any, small: Scene, qtbot: Any, tmp_path: Path) -> None:
    path = tmp_path / "bed.npy"
    np.save(path, -20.0 + np.random.default_rng(1).normal(0.0, 0.1, (300, 300)))
    viewer = open_viewer(small)
    drop(viewer.window, path)
    said = viewer.window.status.sentence
    qtbot.waitUntil(lambda: not said.text().startswith("reading"), timeout=20000)
    assert viewer.session.scene.seabed.relief.kind == "dem"


def test_a_cast_is_dropped(open_viewer: Any, small: Scene, tmp_path: Path) -> None:
    cast = tmp_path / "cast.csv"
    cast.write_text("depth,sound_speed\n0,1500\n10,1495\n40,1490\n", encoding="utf-8")
    viewer = open_viewer(small)
    drop(viewer.window, cast)
    assert viewer.session.scene.water.kind == "cast"


def test_another_file_is_refused_in_one_sentence(open_viewer: Any, small: Scene, tmp_path: Path) -> None:
    (tmp_path / "letter.txt").write_text("x", encoding="utf-8")
    viewer = open_viewer(small)
    drop(viewer.window, tmp_path / "letter.txt")
    assert viewer.window.status.sentence.text().startswith("letter.txt: cannot be opened by its suffix; give a scene")
    assert viewer.session.scene == small


def test_recent_files_are_kept_and_vanished_ones_said_so(open_viewer: Any, small: Scene, tmp_path: Path) -> None:
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
    assert said.endswith("two.toml is no longer there; it was taken from the recent files")
    assert Settings().recent == [str(paths[0])]
    menu.fill()
    next(action for action in menu.actions() if action.text() == "Clear the list").trigger()
    assert Settings().recent == []


def test_the_list_has_an_end(tmp_path: Path) -> None:
    settings = Settings()
    for number in range(RECENT + 5):
        settings.add_recent(str(tmp_path / f"{number}.toml"))
    assert len(Settings().recent) == RECENT
    assert Settings().recent[0].endswith(f"{RECENT + 4}.toml")


@pytest.mark.parametrize("name", ["default", "wreck"])
def test_bundled_scenes_are_not_among_them(open_viewer: Any, small: Scene, name: str) -> None:
    viewer = open_viewer(small)
    viewer.window.scenes.wanted.emit(str(bundled_scenes()[name]))
    assert Settings().recent == []
