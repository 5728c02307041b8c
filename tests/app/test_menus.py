"""Menu bar and tool bar: every command has its place, a key works once, and the tools fit narrow windows."""

from collections import Counter
from importlib.metadata import version
from pathlib import Path

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QGuiApplication, QKeySequence, QShortcut
from PySide6.QtWidgets import QMenu, QToolBar, QToolButton, QWidget

import insonify_viewer
from insonify_viewer.window.help_dialogs import OTHER_KEYS, AboutDialog, KeysDialog


def entries(menu: QMenu) -> list[QAction]:
    """Commands of a menu and of the menus in it."""
    found = [action for action in menu.actions() if not action.isSeparator()]
    return [one for action in found for one in (entries(action.menu()) if action.menu() else [action])]


def activate(window: QWidget, qtbot):
    """Give a window the keyboard, also where no window manager does."""
    window.windowHandle().requestActivate()
    window.activateWindow()
    qtbot.waitUntil(window.isActiveWindow)


def test_every_tool_stands_in_a_menu(window):
    menus = [action.menu() for action in window.menuBar().actions()]
    assert [menu.title().replace("&", "") for menu in menus] == ["File", "Edit", "View", "Record", "Tools", "Help"]
    listed = {action for menu in menus for action in entries(menu)}
    tools = [action for action in window.findChild(QToolBar).actions() if action.text() and not action.isSeparator()]
    assert len(tools) >= 8
    assert set(tools) <= listed
    assert all(menu.actions() for menu in menus)


def test_no_key_stands_for_two_commands(window):
    keys = Counter(action.shortcut().toString() for action in window.findChildren(QAction) if not action.menu())
    del keys[""]
    assert [key for key, times in keys.items() if times > 1] == []


def test_tools_fit_900_px(window, qtbot):
    bar = window.findChild(QToolBar)
    assert bar.sizeHint().width() <= 900
    window.resize(900, 540)
    qtbot.waitUntil(lambda: window.width() == 900)
    assert not window.findChild(QToolButton, "qt_toolbar_ext_button").isVisible()


def test_a_key_of_a_command_in_a_menu_works(window, qtbot):
    activate(window, qtbot)
    qtbot.keyClick(window, Qt.Key.Key_L, Qt.KeyboardModifier.ControlModifier)
    qtbot.waitUntil(lambda: window.panel_widget("lessons").isVisible())


def test_keys_are_listed(window, qtbot):
    activate(window, qtbot)
    qtbot.keyClick(window, "?")
    qtbot.waitUntil(lambda: window.findChild(KeysDialog) is not None)
    pairs = listed_keys(window.findChild(KeysDialog))
    assert {("Save scene", "Ctrl+S"), ("Keep as A", "K"), ("Lessons", "Ctrl+L")} <= pairs
    others = {("show record A while held", "X"), ("find a parameter", "Ctrl+F"), ("zoom about the mouse", "Ctrl+wheel")}
    assert others <= pairs


def test_every_key_that_is_made_is_listed(viewer, qtbot):
    window = viewer.window
    for name in viewer.panels:
        window.open_panel(name)
    dialog = KeysDialog(window, window.menus.all, OTHER_KEYS)
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


def test_about_is_copied(window, qtbot):
    next(action for action in window.menus.help.actions() if action.text().startswith("About")).trigger()
    qtbot.mouseClick(window.findChild(AboutDialog).copy, Qt.MouseButton.LeftButton)
    copied = QGuiApplication.clipboard().text()
    assert f"insonify {version('insonify')}" in copied
    assert "MIT licence" in copied
    assert "To cite it" in copied
