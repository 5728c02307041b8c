"""Command palette and the menu of a record: everything is found by its name, and what is copied works."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QGuiApplication

from insonify.files import bundled_lessons
from insonify.scene import bundled_scenes, load_scene, scene_from_toml
from insonify_viewer.panels.panel import Entry
from insonify_viewer.state.inspection import Mark, mark_of
from insonify_viewer.window.command_palette import find_entries


def test_names_that_begin_with_the_words_come_first():
    names = ("Undo", "beam width", "beam", "Save the beam")
    entries = [Entry("Parameter", name, "", lambda: None) for name in names]
    entries.append(Entry("Scene", "ghosts", "a wide beam", lambda: None))
    found = [entry.name for entry in find_entries(entries, "Beam")]
    assert found == ["beam width", "beam", "Save the beam", "ghosts"]
    assert [entry.name for entry in find_entries(entries, "width beam")] == ["beam width"]
    assert len(find_entries(entries, "")) == 5


def test_the_palette_finds_everything_and_does_it(open_viewer, small, qtbot):
    viewer = open_viewer(small)
    window = viewer.window

    def do(words: str) -> None:
        palette = window.open_palette()
        qtbot.keyClicks(palette.search, words)
        qtbot.keyClick(palette.search, Qt.Key.Key_Down)
        qtbot.keyClick(palette.search, Qt.Key.Key_Up)
        qtbot.keyClick(palette.search, Qt.Key.Key_Return)

    palette = window.open_palette()
    kinds = [entry.kind for entry in palette._entries]
    palette.close()
    assert kinds.count("Scene") == len(bundled_scenes())
    assert kinds.count("Lesson") == len(bundled_lessons())
    assert {"File", "Edit", "View", "Record", "Tools", "Help", "Parameter"} <= set(kinds)
    do("measure a line")
    assert viewer.window.waterfall.measuring
    do("parameter beam width")
    row = viewer.panels["parameters"].view.row("sonar.beam.width")
    assert row.label.property("lit")
    do("lesson first return")
    assert viewer.panels["lessons"].progress is not None
    viewer.panels["lessons"].leave()
    do("scene pipe-on-bed")
    assert viewer.session.scene == load_scene("pipe-on-bed")


def test_the_menu_of_a_record_explains_marks_and_copies(open_viewer, small):
    viewer = open_viewer(small)
    window, mark = viewer.window, Mark(100, 1, 60)
    menu = viewer.record_menu.open(window.waterfall, mark, QPoint(0, 0))
    offered = {action.text(): action for action in menu.actions() if action.text()}
    assert set(offered) >= {"Explain this pixel", "Mark a contact here", "Measure a line", "Keep as A"}
    offered["Explain this pixel"].trigger()
    assert viewer.inspection.mark == mark
    offered["Mark a contact here"].trigger()
    assert [mark_of(contact) for contact in viewer.contacts.all] == [mark]
    clipboard = QGuiApplication.clipboard()
    offered["Copy picture of the record"].trigger()
    assert clipboard.image().width() >= 3 * window.waterfall.width()
    offered["Copy scene as TOML"].trigger()
    assert scene_from_toml(clipboard.text()) == small
    offered["Copy scene as Python"].trigger()
    named: dict[str, Any] = {}
    exec(clipboard.text().replace("record = simulate(scene)", ""), named)
    assert named["scene"] == small
    menu.close()
    menu = viewer.record_menu.open(window.waterfall, mark, QPoint(0, 0))
    assert "Release this pixel" in [action.text() for action in menu.actions()]
    menu.close()
