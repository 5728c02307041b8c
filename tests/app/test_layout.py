"""Menus, tools and palette have their places, there is room for every widget, and words can be told apart and read."""

from collections import Counter
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from controls import activate, assert_side_by_side, colours_of, finish, scenes_by_rows
from PySide6.QtCore import QPoint, QRect, QSize, Qt
from PySide6.QtGui import QAction, QGuiApplication, QImage, QKeySequence, QPainter, QShortcut
from PySide6.QtWidgets import QMenu, QToolBar, QToolButton, QWidget

import insonify_viewer
from insonify.display.range_axis import SLANT, make_range_axis
from insonify.files import bundled_lessons
from insonify.scene import bundled_scenes, edit, load_scene, scene_from_toml
from insonify_viewer.application import enlarge_text
from insonify_viewer.panels.panel import Entry
from insonify_viewer.panels.parameters.view.parameters_view import ParametersView
from insonify_viewer.record.projection import Projection, Zoom, name_scale
from insonify_viewer.record.record_overlays import draw_measured, draw_range_ruler, write_towed
from insonify_viewer.state.inspection import Mark, mark_of
from insonify_viewer.state.sections import sections_of
from insonify_viewer.widgets.field_rows import Combo, NameLabel
from insonify_viewer.widgets.theme import RAISED, Theme, apply_theme
from insonify_viewer.window.command_palette import find_entries
from insonify_viewer.window.help_dialogs import AboutDialog, KeysDialog
from insonify_viewer.window.main_window import place_beside


@pytest.mark.parametrize("name", scenes_by_rows())
def test_no_row_is_cut_off(name, qtbot, qapp):
    view = ParametersView()
    qtbot.addWidget(view)
    view.show_sections(sections_of(load_scene(name)))
    view.resize(ParametersView.narrowest, 900)
    view.show()
    for box in view.sections.values():
        box.unfold(True)
    qapp.processEvents()
    edge = view.viewport().width()
    for child in view.widget().findChildren(QWidget):
        if child.isVisible():
            right = child.mapTo(view.widget(), QPoint(child.width(), 0)).x()
            assert right <= edge, f"{type(child).__name__} {child.objectName()} ends at {right} of {edge} px"
        if child.isVisible() and isinstance(child, NameLabel):
            assert "…" not in child.text()
            words = child.fontMetrics().boundingRect(child.contentsRect(), Qt.TextFlag.TextWordWrap, child.text())
            assert words.width() <= child.contentsRect().width(), child.text()


def test_the_entry_under_the_mouse_can_be_read(qtbot, qapp):
    combo = Combo()
    qtbot.addWidget(combo)
    combo.addItems(["MMMMM", "HHHHH"])
    combo.show()
    combo.showPopup()
    view = combo.view()
    view.setCurrentIndex(combo.model().index(1, 0))
    qapp.processEvents()
    place = view.visualRect(view.currentIndex())
    image = view.viewport().grab(place).toImage()
    grey = np.array([[image.pixelColor(x, y).lightness() for x in range(image.width())] for y in range(image.height())])
    combo.hidePopup()
    assert np.median(grey) < 80
    assert grey.max() > 180, "light words on the dark ground of the selection"


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("theme", [Theme.DARK, Theme.LIGHT])
def test_the_arrow_of_a_list_stands_clear_of_its_edge(theme, scale, qtbot, qapp):
    apply_theme(qapp, theme)
    enlarge_text(qapp, 100 * scale)
    combo = Combo()
    qtbot.addWidget(combo)
    combo.show()
    image = combo.grab().toImage()
    columns, rows = image.width(), range(5, image.height() - 5)
    ground = image.pixelColor(columns // 2, image.height() // 2).lightness()
    ink = [
        max(abs(image.pixelColor(x, y).lightness() - ground) for y in rows) for x in range(columns // 2, columns - 3)
    ]
    drawn = np.flatnonzero(np.array(ink) > 12)
    assert 6 * scale <= drawn[-1] - drawn[0] + 1 <= 14 * scale, "the arrow alone, without a frame of its own"
    assert max(ink) > 50
    assert len(ink) - 1 - drawn[-1] >= 1


def test_the_scale_is_named_and_metres_towed_are_written_to_tenths():
    room = QRect(64, 24, 500, 700)
    assert name_scale(room, 140.0, 100.0) == "1 : 1"
    names = {20.0: "track × 7", 1400.0: "track ÷ 10", 1.25: "track × 112", 56.0: "track × 2.5"}
    assert {along: name_scale(room, along, 100.0) for along in names} == names
    written = {(54.4912, 6.0): "54.5 m", (6.0541, 6.0): "6.1 m", (100.0, 20.0): "100 m", (0.05, 0.05): "0.05 m"}
    assert {given: write_towed(*given) for given in written} == written


ENDS = [((30, 40), (60, 40)), ((380, 150), (340, 150)), ((200, 290), (201, 20)), ((20, 9), (390, 9))]


@pytest.mark.parametrize("ends", ENDS)
def test_what_is_measured_stands_beside_its_line(ends, qapp):
    image, plot = QImage(400, 300, QImage.Format.Format_RGB32), QRect(0, 0, 400, 300)
    image.fill(0)
    first, last = (QPoint(*end) for end in ends)
    with QPainter(image) as painter:
        draw_measured(painter, plot, (first, last), "2.90 m on the bed\nslant range 2.00 m")
    drawn = colours_of(image) == (RAISED.rgb() & 0xFFFFFF)
    (x, y) = (np.flatnonzero(drawn.any(axis=axis)).tolist() for axis in (0, 1))
    found = QRect(QPoint(x[0], y[0]), QPoint(x[-1], y[-1]))
    assert plot.contains(found)
    assert not found.intersects(QRect(first, last).normalized())


@pytest.mark.parametrize(("left", "x"), [(0, 900), (700, 180), (300, 1080), (400, 0)])
def test_another_window_opens_beside(left, x):
    screen, window = QRect(0, 0, 1600, 1000), QRect(left, 40, 900, 700)
    assert place_beside(window, QSize(520, 400), screen) == QPoint(x, 40)


def test_a_measurement_stays_within_a_narrow_record(qapp):
    image, plot = QImage(400, 300, QImage.Format.Format_RGB32), QRect(100, 0, 190, 300)
    image.fill(0)
    words = (
        "2.90 m on the bed: 0 m along the heading of 90°, 2.9 m across\nas a shadow: target 1.08 m high, 1.2 m if round"
    )
    with QPainter(image) as painter:
        draw_measured(painter, plot, (QPoint(180, 60), QPoint(200, 60)), words)
    drawn = colours_of(image)
    assert drawn[:, 100:290].any()
    assert not drawn[:, :100].any()
    assert not drawn[:, 290:].any()


@pytest.mark.parametrize("width", [150, 200, 280, 600])
def test_the_name_of_the_range_leaves_room_for_words_to_its_left(width, qapp):
    axis = make_range_axis(SLANT, 500, 0.1, 10.0)
    projection = Projection(axis, "both", True, Zoom(), 99, 100, lambda pings: np.full(pings.shape, 10.0))
    image, taken = QImage(800, 200, QImage.Format.Format_RGB32), 60
    image.fill(0)
    with QPainter(image) as painter:
        draw_range_ruler(painter, QRect(70, 30, width, 100), projection, "track × 2", 1.0, taken)
        name_width = painter.fontMetrics().horizontalAdvance("slant range (m)")
    line = colours_of(image)[150:168].any(axis=0)
    assert not line[: 70 + taken].any()
    drawn = np.flatnonzero(line)
    assert drawn[-1] - drawn[0] >= 0.9 * min(name_width, width - taken)
    if width == 600:
        assert 0.5 * (drawn[0] + drawn[-1]) == pytest.approx(70 + 300, abs=3), "in the middle where there is room"


def test_the_record_fills_its_pane_at_each_scale_and_panels_stay_in_the_window(open_viewer, small, qtbot):
    viewer = open_viewer(edit(small, {"track.pings": 512}))
    window, waterfall, lessons = viewer.window, viewer.window.waterfall, viewer.panels["lessons"].widget
    filled, whole = waterfall.plot_area, Zoom()
    assert waterfall.projection.zoom == whole
    viewer.session.show(scale="true")
    one, other = waterfall.place_of(Mark(500, 1, 0)), waterfall.place_of(Mark(480, 1, 8))
    # 20 pings of 0.2 m; 8 bins of 0.5 m.
    assert other.y() - one.y() == pytest.approx(other.x() - one.x(), abs=2)
    assert waterfall.plot_area == filled
    viewer.session.show(scale="fill")
    viewer.session.settle({"track.speed": 1.0})
    assert waterfall.mark_at(waterfall.place_of(Mark(500, 1, 0))) == Mark(500, 1, 0)
    viewer.session.undo()
    window.resize(1560, 980)
    qtbot.waitUntil(lambda: waterfall.height() > 800)
    plot, area = waterfall.plot_area, waterfall.trace_area()
    assert plot.height() + area.height() > 0.85 * waterfall.height()
    assert plot.width() >= waterfall.width() - 110, "but for the rulers"
    assert area.height() <= 0.2 * waterfall.height()
    # Panels at both sides stay within the window, and return to their places.
    shown = [viewer.panels["parameters"].widget, waterfall]
    for width in (780, 900, 1000, 1600, 900):
        window.resize(width, 540)
        qtbot.waitUntil(lambda width=width: window.width() == width)
        for more in ([], [lessons], []):
            window.buttons["lessons"].setChecked(bool(more))
            qtbot.waitUntil(lambda more=more: lessons.isVisible() == bool(more))
            qtbot.wait(100)
            assert window.width() == width
            assert_side_by_side(window, *shown, *more)
            assert not any(each.visibleRegion().isEmpty() for each in (*shown, *more))
            assert waterfall.width() >= 200
            assert window.seabed.isVisible()
    # Record and seabed keep room beside a lesson and rays.
    views, places = window.views, [viewer.panels[name].widget for name in ("parameters", "lessons")]
    for width, height in ((1600, 1000), (1280, 800)):
        window.resize(width, height)
        for panel in ("lessons", "water"):
            window.open_panel(panel)
        qtbot.waitUntil(lambda: views.width() * views.height() >= 0.45 * window.width() * window.height())
        assert (window.width(), window.height()) == (width, height)
        seen = *places, viewer.panels["water"].view.rays.surface
        assert all(not place.visibleRegion().isEmpty() for place in seen), "none hides another"
        assert waterfall.width() > window.seabed.width()
        if width == 1280:
            qtbot.waitUntil(lambda: places[1].height() > 1.3 * places[0].height())
            assert waterfall.trace_area() is None, "the record has its room"
            window.trace.trigger()
            assert waterfall.trace_area() is not None, "unless the person asks for it"
        for panel in ("lessons", "water"):
            window.buttons[panel].setChecked(False)
        window.open_panel("lessons")
        # At the left of the views, where there is room.
        edge = views.x if width > 1500 else window.width
        qtbot.waitUntil(lambda edge=edge: places[1].mapTo(window, QPoint(0, 0)).x() < edge())


def entries(menu: QMenu) -> list[QAction]:
    """Commands of a menu and of the menus in it."""
    found = [action for action in menu.actions() if not action.isSeparator()]
    return [one for action in found for one in (entries(action.menu()) if action.menu() else [action])]


def test_tools_fit_the_window_and_stand_in_menus_with_their_keys_which_are_all_listed(viewer, qtbot, monkeypatch):
    window = viewer.window
    bar = window.findChild(QToolBar)
    assert bar.sizeHint().width() <= 900
    window.resize(900, 540)
    qtbot.waitUntil(lambda: window.width() == 900)
    assert not window.findChild(QToolButton, "qt_toolbar_ext_button").isVisible()
    assert window.minimumSizeHint().width() <= 800
    window.resize(800, 450)
    qtbot.waitUntil(lambda: window.width() == 800)
    finish(viewer, qtbot, window.open_panel, "water")
    assert window.size().width() <= 800
    # Every tool stands in a menu.
    menus = [action.menu() for action in window.menuBar().actions()]
    assert [menu.title().replace("&", "") for menu in menus] == ["File", "Edit", "View", "Record", "Tools", "Help"]
    listed = {action for menu in menus for action in entries(menu)}
    tools = [action for action in bar.actions() if action.text() and not action.isSeparator()]
    assert len(tools) >= 8
    assert set(tools) <= listed
    assert all(menu.actions() for menu in menus)
    # The words about the program are copied.
    next(action for action in window.menus.help.actions() if action.text().startswith("About")).trigger()
    about = window.findChild(AboutDialog)
    qtbot.mouseClick(about.copy, Qt.MouseButton.LeftButton)
    about.close()
    copied = QGuiApplication.clipboard().text()
    assert f"insonify {version('insonify')}" in copied
    assert "MIT licence" in copied
    assert "LGPL" in copied
    assert "To cite it" in copied
    # The window lies on its screen with its frame.
    room = window.screen().availableGeometry()
    monkeypatch.setattr(window, "frameGeometry", lambda: window.geometry().adjusted(-4, -30, 4, 4))
    window.resize(room.size())
    window.fit_screen()
    assert window.frameGeometry().size().boundedTo(room.size()) == window.frameGeometry().size()
    assert window.statusBar().isVisible()
    # A key of a command in a menu works and stands for no other one, and every key is listed.
    keys = Counter(action.shortcut().toString() for action in window.findChildren(QAction) if not action.menu())
    del keys[""]
    assert [key for key, times in keys.items() if times > 1] == []
    activate(window, qtbot)
    qtbot.keyClick(window, Qt.Key.Key_L, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: window.docks.by_panel["lessons"].isVisible())
    qtbot.keyClick(window, "?")
    qtbot.waitUntil(lambda: window.findChild(KeysDialog) is not None)
    pairs = listed_keys(window.findChild(KeysDialog))
    assert {("Save scene", "Ctrl+S"), ("Keep as A", "K"), ("Lessons", "Ctrl+L")} <= pairs
    others = {("show record A while held", "X"), ("find a parameter", "Ctrl+F"), ("zoom about the mouse", "Ctrl+wheel")}
    assert others <= pairs
    for name in viewer.panels:
        window.open_panel(name)
    dialog = KeysDialog(window, window.menus.all)
    listed = {key for _, keys in listed_keys(dialog) for key in (keys, *keys.split())}
    native = QKeySequence.SequenceFormat.NativeText
    actions = {action.shortcut().toString(native) for action in window.findChildren(QAction)} - {""}
    assert actions - listed == set()
    shortcuts = [shortcut.key().toString(native) for shortcut in window.findChildren(QShortcut)]
    assert set(shortcuts) - listed == set()
    sources = Path(insonify_viewer.__file__).parent.rglob("*.py")
    made = sum(path.read_text(encoding="utf-8").count("QShortcut(") for path in sources)
    assert len(shortcuts) >= made, "this test sees every shortcut that is made"


def listed_keys(dialog: KeysDialog) -> set[tuple[str, str]]:
    """What the list of keys shows: commands with their keys."""
    groups = (dialog.list.topLevelItem(number) for number in range(dialog.list.topLevelItemCount()))
    rows = (group.child(number) for group in groups for number in range(group.childCount()))
    return {(row.text(0), row.text(1)) for row in rows}


def test_names_that_begin_with_the_words_come_first():
    names = ("Undo", "beam width", "beam", "Save the beam")
    entries = [Entry("Parameter", name, "", lambda: None) for name in names]
    entries.append(Entry("Scene", "ghosts", "a wide beam", lambda: None))
    found = [entry.name for entry in find_entries(entries, "Beam")]
    assert found == ["beam width", "beam", "Save the beam", "ghosts"]
    assert [entry.name for entry in find_entries(entries, "width beam")] == ["beam width"]
    assert len(find_entries(entries, "")) == 5


def test_the_menu_of_a_record_explains_marks_and_copies_and_the_palette_finds_and_does_everything(viewer, small, qtbot):
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

    # The palette finds everything and does it.
    def do(words: str) -> None:
        palette = window.open_palette()
        qtbot.keyClicks(palette.search, words)
        for key in (Qt.Key.Key_Down, Qt.Key.Key_Up, Qt.Key.Key_Return):
            qtbot.keyClick(palette.search, key)

    palette = window.open_palette()
    kinds = [entry.kind for entry in palette._entries]
    palette.close()
    assert kinds.count("Scene") == len(bundled_scenes())
    assert kinds.count("Lesson") == len(bundled_lessons())
    assert {"File", "Edit", "View", "Record", "Tools", "Help", "Parameter"} <= set(kinds)
    do("measure a line")
    assert window.waterfall.measuring
    do("parameter beam width")
    assert viewer.panels["parameters"].view.row("sonar.beam.width").label.property("lit")
    do("lesson first return")
    assert viewer.panels["lessons"].progress is not None
    viewer.panels["lessons"].leave()
    do("scene pipe-on-bed")
    assert viewer.session.scene == load_scene("pipe-on-bed")
