"""Actions by the menus, in which every command of the window and of its panels stands."""

from PySide6.QtWidgets import QApplication, QDialog, QMenu

from insonify_viewer.viewer import Viewer
from soak.actions import Random, Steps, action
from soak.input import pick

LEFT_OUT = ("Quit",)


@action(4.0)
def give_command(viewer: Viewer, random: Random) -> Steps:
    """Give a command of any menu, and close what it opens before long."""
    commands = [
        command
        for menu in viewer.window.menus.all
        for part in (menu, *menu.findChildren(QMenu))
        for command in part.actions()
        if command.isEnabled() and not command.isSeparator() and not command.menu() and command.text() not in LEFT_OUT
    ]
    command = pick(commands, random)
    command.trigger()
    yield float(random.choice([30.0, 300.0, 1500.0]))
    if command.isCheckable() and command.isChecked():
        command.trigger()
    for dialog in (widget for widget in QApplication.topLevelWidgets() if isinstance(widget, QDialog)):
        dialog.close()
