"""All panels of a window, and the events that they receive together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from psygnal import Signal

from insonify_viewer.panels import find_panels
from insonify_viewer.panels.panel import Panel, Workbench
from insonify_viewer.record.record import RecordGrowth

if TYPE_CHECKING:
    from insonify.simulation import Simulation


class PanelSet(dict[str, Panel]):
    """Every panel that is found, by name, in the order in which the window shows them."""

    # The events of `Panel`, with the arguments of its methods.
    scene_changed = Signal(object, bool)
    scene_refused = Signal()
    plan_made = Signal(object)
    record_grown = Signal(object)
    point_marked = Signal(object)
    part_added = Signal(str)
    fields_lit = Signal(tuple)
    projected = Signal(bool)
    closing = Signal()

    def __init__(self, workbench: Workbench) -> None:
        super().__init__({panel.name: panel(workbench) for panel in find_panels()})
        for panel in self.values():
            self.scene_changed.connect(panel.scene_changed)
            self.scene_refused.connect(panel.scene_refused)
            self.plan_made.connect(panel.plan_made)
            self.record_grown.connect(panel.record_grown)
            self.point_marked.connect(panel.point_marked)
            self.part_added.connect(panel.part_added)
            self.fields_lit.connect(panel.fields_lit)
            self.projected.connect(panel.projected)
            self.closing.connect(panel.closing)
            if not panel.widget.accessibleName():
                panel.widget.setAccessibleName(panel.title)
        self._planned: Simulation | None = None  # the one whose plan they show

    @property
    def complete(self) -> bool:
        """Whether every panel shows the present state."""
        return all(panel.complete for panel in self.values())

    @property
    def at_rest(self) -> bool:
        """Whether no panel measures anything in the background."""
        return all(panel.at_rest for panel in self.values())

    def show_growth(self, growth: RecordGrowth) -> None:
        """Announce new pings, after another plan if they are traced by one."""
        simulation = growth.answer.simulation
        if growth.current and simulation is not self._planned:
            self._planned = simulation
            self.plan_made.emit(simulation.plan)
        self.record_grown.emit(growth)
