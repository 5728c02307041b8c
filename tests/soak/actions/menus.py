"""Actions by the menus, in which every command stands, on jobs beside the window and in lessons."""

import os
from pathlib import Path
from typing import Any

from PySide6.QtWidgets import QApplication, QDialog, QMenu

from insonify_viewer.viewer import Viewer
from soak.actions import Random, Steps, action
from soak.input import pick


@action(4.0)
def give_command(viewer: Viewer, random: Random) -> Steps:
    """Give a command of any menu, and close what it opens before long."""
    commands = [
        command
        for menu in viewer.window.menus.all
        for part in (menu, *menu.findChildren(QMenu))
        for command in part.actions()
        if command.isEnabled() and not command.isSeparator() and not command.menu() and command.text() != "Quit"
    ]
    command = pick(commands, random)
    command.trigger()
    yield float(random.choice([30.0, 300.0, 1500.0]))
    if command.isCheckable() and command.isChecked():
        command.trigger()
    for dialog in (widget for widget in QApplication.topLevelWidgets() if isinstance(widget, QDialog)):
        dialog.close()


@action(0.5)
def work_beside(viewer: Viewer, random: Random) -> Steps:
    """Begin a job of any kind, look at it, and mostly stop it before its end."""
    panel: Any = viewer.panels["jobs"]
    viewer.window.open_panel("jobs")
    folder = Path(os.environ["XDG_STATE_HOME"]) / f"job-{len(viewer.jobs.jobs)}-{random.integers(1_000_000)}"
    folder.mkdir()
    match random.integers(4):
        case 0:
            panel.write_record(folder / str(random.choice(["record.nc", "record.xtf", "record.png"])))
        case 1:
            panel.measure_chart("accuracy", folder / "chart.png")
        case 2:
            made = folder / "set"
            viewer.jobs.begin("data set", ["dataset", "mines", "-o", str(made), "--scenes", "4"], made)
        case 3:
            panel.write_stability_page(folder / "stability.html")
    yield float(random.choice([20.0, 3000.0, 15_000.0]))
    for job in viewer.jobs.running:
        if random.random() < 0.8:
            job.stop()
    yield 500.0
    panel.view.close()
    if random.random() < 0.5:
        panel.view.forget.click()


@action(1.0)
def take_lesson(viewer: Viewer, random: Random) -> Steps:
    """Take a few steps of a lesson, now and then back, answer some of their questions, and mostly leave it."""
    viewer.window.open_panel("lessons")
    panel = viewer.panels["lessons"]
    page = panel.view.page
    panel.start(pick(panel._lessons, random).name)
    yield float(random.choice([100.0, 1500.0]))
    for _ in range(random.integers(1, 8)):
        if page.ask.isVisible() and random.random() < 0.5:
            page.ask.unknown.click()
        page.show_me.click()
        yield float(random.choice([20.0, 800.0]))
        (page.next if random.random() < 0.8 else page.back).click()
        yield float(random.choice([20.0, 800.0]))
    if random.random() < 0.7:
        page.left.click()
        yield 50.0
