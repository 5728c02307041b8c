"""Files of every kind dropped on the window, the list of recent files, and text of files, none of which is obeyed."""

import re
import shutil
from pathlib import Path

import numpy as np
from controls import answer_questions, drop
from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QTextDocumentFragment
from PySide6.QtWidgets import QAbstractButton, QFileDialog, QLabel, QListWidget, QMessageBox, QWidget

from insonify import simulate
from insonify.io.contacts import Contact, read_contacts, write_contacts
from insonify.io.records import write_record
from insonify.scene import bundled_meshes, bundled_scenes, edit, scene_to_toml
from insonify.surveys.lines.specification import SurveySpecification
from insonify_viewer.widgets.save_dialogs import ask_about_changes
from insonify_viewer.widgets.text import entry_name, literal, one_line, window_title
from insonify_viewer.window.settings import RECENT, Settings


def said(viewer) -> str:
    return str(viewer.window.status.sentence.text())


def open_again(viewer, name: str):
    """Trigger an entry of the list of recent files."""
    menu = viewer.window.recent
    menu.fill()
    next(action for action in menu.actions() if action.text() == name).trigger()


def test_a_mesh_and_a_bed_are_dropped_and_opened_again_after_a_question(viewer, small, qtbot, tmp_path, monkeypatch):
    path = Path(shutil.copy(bundled_meshes()["drum"], tmp_path))
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
    # So is a bed.
    viewer.session.undo(2)
    bed = tmp_path / "bed.npy"
    np.save(bed, -20.0 + np.random.default_rng(1).normal(0.0, 0.1, (300, 300)))
    for attempt in (drop, lambda window, _: open_again(viewer, "bed.npy")):
        attempt(viewer.window, bed)
        qtbot.waitUntil(lambda: viewer.session.scene.seabed.relief.kind == "dem")
        assert said(viewer).endswith("the 3 targets were removed with the scene before (Undo restores it)")
        assert Settings().recent == [str(bed), str(path)]
        viewer.session.undo()
        assert viewer.session.scene == small
    # It asks about unsaved changes.
    asked = answer_questions(monkeypatch, QMessageBox.StandardButton.Cancel, QMessageBox.StandardButton.Discard)
    viewer.session.settle({"track.altitude": 7.0})
    changed = viewer.session.scene
    drop(viewer.window, bed)
    qtbot.wait(100)
    assert viewer.session.scene is changed
    assert not said(viewer).startswith("reading")
    drop(viewer.window, bed)
    qtbot.waitUntil(lambda: viewer.session.scene.seabed.relief.kind == "dem")
    assert asked == [f"The scene “{small.title}” has changes that are not saved."] * 2


def test_a_cast_and_navigation_are_dropped_opened_again_or_taken_by_a_field_and_others_refused(
    open_viewer, small, qtbot, tmp_path, monkeypatch
):
    cast, tow, letter, sums = (tmp_path / name for name in ("cast.csv", "tow.csv", "letter.txt", "sums.csv"))
    cast.write_text("depth,sound_speed\n0,1500\n10,1495\n40,1490\n", encoding="utf-8")
    tow.write_text("time,x,y,heading\n" + "".join(f"{t},{2 * t},0,0\n" for t in range(31)), encoding="utf-8")
    letter.write_text("x", encoding="utf-8")
    sums.write_text("a,b\n1,2\n", encoding="utf-8")
    viewer = open_viewer(edit(small, {"water.absorption": 12.0, "sonar.ping_rate": 15.0}))
    before = viewer.session.scene
    drop(viewer.window, cast, tow)
    assert said(viewer) == "2 files were dropped at once; drop one file at a time"
    drop(viewer.window, letter)
    assert said(viewer).startswith("letter.txt: cannot be opened by its suffix; give a scene")
    drop(viewer.window, sums)
    qtbot.waitUntil(lambda: "has no column time" in said(viewer))
    assert viewer.session.scene == before
    assert Settings().recent == []
    for attempt in (drop, lambda window, _: open_again(viewer, "cast.csv")):
        attempt(viewer.window, cast)
        qtbot.waitUntil(lambda: viewer.session.scene.water.kind == "cast")
        assert viewer.session.scene.water.absorption.coefficient == 12.0, "the rest of the water stays"
        assert said(viewer).startswith("sound speed of cast.csv: 3 depths, down to 40 m; ping rate lowered to")
        assert viewer.window.undo.text() == "Undo: sound speed of cast.csv"
        assert Settings().recent == [str(cast)]
        viewer.session.undo()
        assert viewer.session.scene == before
    for attempt in (drop, lambda window, _: open_again(viewer, "tow.csv")):
        attempt(viewer.window, tow)
        qtbot.waitUntil(lambda: viewer.session.scene.track.motion.kind == "recorded")
        assert viewer.session.scene.track.motion.path == str(tow)
        assert said(viewer) == "navigation of tow.csv: x, y, heading at 31 times, 30 s in all"
        assert viewer.window.undo.text() == "Undo: navigation of tow.csv"
        assert Settings().recent == [str(tow), str(cast)]
        viewer.session.undo()
        assert viewer.session.scene == before
    # One that a field takes over is among the recent ones.
    Settings().forget_recent()
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


def test_recent_scenes_and_contacts_are_opened_again_unless_they_vanished(viewer, small, tmp_path, monkeypatch):
    paths = [tmp_path / f"{name}.toml" for name in ("one", "two")]
    for number, path in enumerate(paths):
        path.write_text(scene_to_toml(edit(small, {"seed": number + 7})), encoding="utf-8")
        drop(viewer.window, path)
    menu = viewer.window.recent
    menu.fill()
    assert [action.text() for action in menu.actions()[:2]] == ["two.toml", "one.toml"]
    open_again(viewer, "one.toml")
    assert viewer.session.scene.seed == 7
    paths[1].unlink()
    menu.fill()
    assert [action.text() for action in menu.actions()[:2]] == ["one.toml", "two.toml  (no longer there)"]
    menu.actions()[1].trigger()
    assert said(viewer).endswith("two.toml is no longer there; it was removed from the recent files")
    assert Settings().recent == [str(paths[0])]
    open_again(viewer, "Clear the list")
    assert Settings().recent == []
    settings = Settings()
    for number in range(RECENT + 5):
        settings.add_recent(str(tmp_path / f"{number}.toml"))
    assert (len(Settings().recent), Settings().recent[0]) == (RECENT, str(tmp_path / f"{RECENT + 4}.toml"))
    open_again(viewer, "Clear the list")
    # Bundled scenes are not among them.
    path = tmp_path / "other.toml"
    path.write_text(scene_to_toml(edit(small, {"track.altitude": 6.5})), encoding="utf-8")
    for name in ("default", "pipe-on-bed"):
        viewer.window.scenes.wanted.emit(str(bundled_scenes()[name]))
        assert Settings().recent == [], "one that comes with the program is not among them"
    drop(viewer.window, path)
    assert viewer.session.scene.track.altitude == 6.5
    assert viewer.session.file == str(path)
    # Contacts are among them, which the menu opens too.
    for path in (tmp_path / "found.geojson", tmp_path / "found.csv"):
        write_contacts(path, [Contact(name, "", "line.xtf", 3, "port", 12, 2.5) for name in ("wreck", "rock")])
        drop(viewer.window, path)
        assert [each.name for each in viewer.contacts.all] == ["wreck", "rock"]
        assert said(viewer) == f"2 contacts of {path.name}"
        assert viewer.window.undo.text() == f"Undo: open {path.name}"
        viewer.window.undo.trigger()
        assert not viewer.contacts.all
        monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_, path=path: (str(path), ""))
        next(action for action in viewer.window.menus.file.actions() if action.text() == "Open contacts…").trigger()
        assert len(viewer.contacts) == 2
        assert not viewer.window.isWindowModified()
        viewer.contacts.remove(0)
        assert viewer.window.isWindowModified()
        open_again(viewer, path.name)
        assert len(viewer.contacts) == 2
        viewer.session.undo(3)


SHOWN = "<img src=x> R&D &amp; <b>loud"  # a name of a file as well: without a slash
HOSTILE = f"\x1b]0;owned\x07\u202e{SHOWN}[*]\u2066"
OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def rich(text: str, form: Qt.TextFormat = Qt.TextFormat.AutoText) -> str:
    """Return what a widget shows of a text that may be HTML."""
    as_html = form is Qt.TextFormat.RichText or (form is Qt.TextFormat.AutoText and re.search("<[a-z!/]", text))
    return QTextDocumentFragment.fromHtml(text).toPlainText() if as_html else text


def without_shortcuts(text: str) -> str:
    """Return what a menu or a button shows of a text."""
    return re.sub("&(.)", r"\1", text)


def shown_texts(top: QWidget) -> list[tuple[str, str]]:
    """List every text that a window shows, with where it does."""
    found = [("title", top.windowTitle().replace("[*][*]", "[mark]").replace("[*]", "").replace("[mark]", "[*]"))]
    for widget in [top, *top.findChildren(QWidget)]:
        name = f"{type(widget).__name__} {widget.objectName()}"
        found.append((f"tip of {name}", rich(widget.toolTip())))
        if isinstance(widget, QLabel):
            found.append((name, rich(widget.text(), widget.textFormat())))
        if isinstance(widget, QAbstractButton):
            found.append((name, without_shortcuts(widget.text())))
        if isinstance(widget, QListWidget):
            entries = [widget.item(row) for row in range(widget.count())]
            found += [(name, entry.text()) for entry in entries] + [(name, rich(entry.toolTip())) for entry in entries]
    for action in top.findChildren(QAction):
        found += [("action", without_shortcuts(action.text())), ("tip of action", rich(action.toolTip()))]
    return found


def test_text_of_files_is_shown_as_it_is(open_viewer, small, tmp_path, qtbot):
    viewer, known = open_viewer(edit(small, {"title": HOSTILE, "description": HOSTILE})), set()

    def assert_plain(more: int) -> None:
        """Check all texts that are shown, at least so many more than before."""
        qtbot.waitUntil(lambda: viewer.complete)
        qtbot.wait(50)
        marked = {(where, text) for where, text in shown_texts(viewer.window) if "img src" in text}
        assert len(marked - known) >= more, marked
        for where, text in marked:
            assert SHOWN in text, where
            assert not OBEYED.search(text), where
        known.clear()
        known.update(marked)

    assert_plain(4)  # the title of the scene is in the title of the window
    viewer.window.status.say(f"{HOSTILE}: does not exist", lasting=True)
    assert_plain(2)
    viewer.window.settings.add_recent(str(tmp_path / f"{HOSTILE}.toml"))
    viewer.window.recent.fill()
    assert_plain(2)
    # A contact is changed, and another one removed: the history names it.
    contact = Contact(HOSTILE, HOSTILE, HOSTILE, 3, "port", 40, 9.0)
    write_contacts(tmp_path / "contacts.csv", [contact, contact])
    viewer.contacts.open(read_contacts(tmp_path / "contacts.csv"), "contacts.csv")
    viewer.contacts.edit(0, "note", "a rock")
    viewer.contacts.remove(1)
    assert_plain(4)
    viewer.comparison.keep()
    viewer.session.settle({"track.altitude": 7.0})
    assert_plain(1)
    path = tmp_path / f"{HOSTILE}.nc"
    write_record(path, [simulate(edit(viewer.session.scene, {"track.pings": 4})).assign_attrs(title=HOSTILE)])
    viewer.recordings.open(str(path))
    assert_plain(2)
    viewer.jobs.begin_work(f"chart of {HOSTILE}", lambda report: None)
    assert_plain(2)


def test_text_of_files_is_made_plain_in_a_question_and_in_declared_words(small, qapp, monkeypatch):
    assert literal("a < b & c\x1b") == "<span>a &lt; b &amp; c</span>"
    assert literal("R&D\x9b") == "R&D"
    assert entry_name("R&D\tx\ny") == "R&&D x y"
    assert window_title("a[*]\x07") == "a[*][*]"
    assert one_line(" a\n\u202eb ") == "a b"
    asked = answer_questions(monkeypatch, QMessageBox.StandardButton.Cancel)
    ask_about_changes(None, [f"the scene “{HOSTILE}”"])
    assert SHOWN in rich(asked[0])
    assert not OBEYED.search(asked[0])
    assert edit(small, {"title": HOSTILE}).title == "]0;owned" + SHOWN + "[*]"
    lines = [{"start": [0, 0], "end": [9, 0]}]
    page = SurveySpecification.model_validate({"base": "default", "title": HOSTILE, "lines": lines})
    assert not OBEYED.search(page.title)
