"""What the menus of the window hold, and the icons of its tools."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QToolButton

from insonify_viewer.widgets.icons import set_icon
from insonify_viewer.window.help_dialogs import AboutDialog, KeysDialog
from insonify_viewer.window.key_list import OTHER_KEYS
from insonify_viewer.window.looks_menu import LooksMenu
from insonify_viewer.window.menus import Menus

if TYPE_CHECKING:
    from insonify_viewer.window.main_window import MainWindow


def fill_menus(window: MainWindow, menus: Menus) -> LooksMenu:
    """Put every command into the menus, before those of panels; return the choice of theme and size."""
    menus.file.addMenu(window.scenes.menu()).setText("Scenes")
    menus.group("File", [window.open_scene, window.open_recording, window.open_dem])
    contacts = menus.add("File", "Open contacts…", "Open a file of contacts in place of those in the list")
    contacts.triggered.connect(lambda: window.contacts_wanted.emit())
    menus.file.addMenu(window.recent)
    menus.group("File", [window.save.scene, window.save.record, window.save.picture])
    menus.file.addSeparator()
    menus.add("File", "Quit", "Close the window", "Ctrl+Q").triggered.connect(window.close)
    menus.group("Edit", [window.undo, window.redo])
    menus.edit.addSeparator()
    menus.edit.addMenu(window.targets.menu()).setText("Add a target")
    menus.group("Record", [window.pause, window.levels, window.trace])
    menus.group("Record", window.comparison.actions)
    menus.group("Tools", [window.save.jobs])
    menus.group("View", [window.projector, window.reset_view])
    looks = LooksMenu(window, menus.view, window.settings, window.say)
    menus.view.addSeparator()
    keys = menus.add("Help", "Keyboard shortcuts", "Every command that has a key, and the keys of views", "?")
    keys.triggered.connect(lambda: KeysDialog(window, menus.all, OTHER_KEYS).show())
    menus.add("Help", "Tour", "Five steps through the window").triggered.connect(window.tour.begin)
    about = menus.add("Help", "About insonify", "Versions, licence, citation")
    about.triggered.connect(lambda: AboutDialog(window).show())
    _show_icons(window)
    return looks


def _show_icons(window: MainWindow) -> None:
    """Give the tools icons, and names to those who reach them by keyboard."""
    for owner, name in (
        (window.scenes, "scenes"), (window.targets, "target"), (window.save, "save"), (window.undo, "undo"),
        (window.redo, "redo"), (window.pause, "pause"), (window.reset_view, "home"), (window.levels, "levels"),
    ):  # fmt: skip
        set_icon(owner, name)
    for button in window.findChildren(QToolButton):
        name_button(button)


def name_button(button: QToolButton) -> None:
    """Let the keyboard reach a tool, and give it a name for screen readers."""
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    button.setAccessibleName(button.toolTip())
