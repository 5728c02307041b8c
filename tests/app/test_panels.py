"""Panels are found by being there or by being announced, mounted in order, and told of what happens."""

from functools import partialmethod
from importlib.metadata import EntryPoint
from typing import Any

import pytest
from PySide6.QtWidgets import QDockWidget, QLabel

from insonify.plugins import announced, modules_in
from insonify.scene import edit
from insonify_viewer import panels
from insonify_viewer.panels import GROUP, find_panels
from insonify_viewer.panels.panel import Button, Panel, Place, Workbench
from insonify_viewer.state.inspection import Mark

OWN = ["parameters", "plan", "record", "budget", "chart", "comparison", "jobs", "lessons", "pixel", "readout", "tow"]
OWN += ["water", "error"]  # at the right


class DummyPanel(Panel):
    """Writes down what it is told."""

    name = "dummy"
    title = "Dummy"
    place = Place.SIDE
    complete = True

    def __init__(self, workbench: Workbench):
        self.workbench = workbench
        self.told: list[tuple[Any, ...]] = []
        self.view = QLabel("dummy")

    def note(self, what: str, *given: Any):
        self.told.append((what, *given))

    scene_changed = partialmethod(note, "scene")
    scene_refused = partialmethod(note, "refused")
    record_grown = partialmethod(note, "record")
    plan_made = partialmethod(note, "plan")
    point_marked = partialmethod(note, "point")
    opened = partialmethod(note, "opened")
    closing = partialmethod(note, "closing")

    def notes(self, what: str) -> list[Any]:
        return [given[0] for kind, *given in self.told if kind == what]


class DummyBelow(DummyPanel):
    name = "dummy-below"
    place = Place.BELOW
    button = Button("Dummy", "Show the dummy", "Ctrl+Shift+D")


class DummyWindow(DummyPanel):
    name = "dummy-window"
    place = Place.WINDOW
    button = Button("Window", "Show the dummy's window", "Ctrl+Shift+W")


@pytest.fixture
def announce(monkeypatch):
    """Let an installed package announce panel classes of this file as entry points."""

    def add(*classes):
        entries = [EntryPoint(cls.name, f"{cls.__module__}:{cls.__name__}", GROUP) for cls in classes]
        monkeypatch.setattr(panels, "announced", lambda group: [*announced(group), *entries])

    return add


def test_every_folder_holds_a_panel_and_their_order_is_stable(announce):
    folders = [module for module in modules_in("insonify_viewer.panels") if hasattr(module, "__path__")]
    assert folders
    found = find_panels()
    assert {folder.PANEL for folder in folders} == set(found)
    assert [panel.name for panel in found] == OWN
    for panel in found:
        assert Panel in panel.__mro__
        assert panel.title
        assert (panel.__doc__ or "").strip()
    announce(DummyBelow, DummyPanel)
    assert [panel.name for panel in find_panels()] == [*OWN[:6], "dummy", "dummy-below", *OWN[6:]]


def test_an_announced_panel_is_a_tab_or_opens_by_its_button_and_edits_the_scene(open_viewer, small, qtbot, announce):
    announce(DummyPanel, DummyBelow, DummyWindow)
    viewer = open_viewer(small)
    dummy = viewer.panels["dummy"]
    dock = viewer.window.findChild(QDockWidget, "dummy")
    assert dock.widget() is dummy.widget
    assert viewer.window.tabifiedDockWidgets(dock)
    assert dummy.widget.visibleRegion().isEmpty(), "the first tab is in front"
    dummy.workbench.open_panel("dummy")
    qtbot.waitUntil(lambda: not dummy.widget.visibleRegion().isEmpty())
    assert dummy.told[0] == ("scene", small, True)
    assert "sweep" in [plan.method for plan in dummy.notes("plan")]
    assert (True, True) in [(growth.current, growth.complete) for growth in dummy.notes("record")]
    viewer.session.drag({"track.altitude": 8.0})
    lower = edit(small, {"track.altitude": 8.0})
    assert dummy.told[-1] == ("scene", lower, False)
    viewer.session.settle()
    assert dummy.told[-1] == ("scene", lower, True)
    plans = len(dummy.notes("plan"))
    qtbot.waitUntil(lambda: len(dummy.notes("plan")) == plans + 1)
    qtbot.waitUntil(lambda: viewer.complete)
    dummy.complete = False
    assert not viewer.complete, "a snapshot waits for every panel"
    dummy.complete = True
    assert viewer.complete
    # One below and one in a window open by their buttons.
    below, window = viewer.panels["dummy-below"], viewer.panels["dummy-window"]
    actions = {action.text(): action for action in viewer.window.menus.view.actions()}
    assert "Ctrl+Shift+D" in actions["Dummy"].toolTip()
    assert not below.widget.isVisible()
    actions["Dummy"].trigger()
    assert below.widget.isVisible()
    actions["Dummy"].trigger()
    assert not below.widget.isVisible()
    assert below.told[-2:] == [("opened", True), ("opened", False)]
    actions["Window"].trigger()
    assert window.widget.isVisible()
    assert window.widget.isWindow()
    # It may edit the scene, and is told of the point under the mouse.
    viewer.panels["dummy"].workbench.session.settle({"track.altitude": 7.0})
    assert viewer.session.scene.altitude == 7.0
    assert viewer.panels["parameters"].view.row("track.altitude").field.text() == "7 m"
    waterfall = viewer.window.waterfall
    waterfall.hovered.emit(Mark(ping=100, side=0, bin=4))
    kind, point = viewer.panels["dummy"].told[-1]
    assert (kind, point.slant_range, point.ground_range) == ("point", 2.25, None)
    waterfall.hovered.emit(None)
    assert viewer.panels["dummy"].told[-1] == ("point", None)
    viewer.session.settle({"seed": 666})
    qtbot.waitUntil(lambda: ("refused",) in dummy.told)
    viewer.window.close()
    assert dummy.told[-1] == ("closing",)
