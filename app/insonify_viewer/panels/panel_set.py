"""All panels of a window, told together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from insonify_viewer.panels import find_panels
from insonify_viewer.panels.panel import Panel, RecordGrowth, Workbench

if TYPE_CHECKING:
    from insonify.simulation import Simulation


class PanelSet(dict[str, Panel]):
    """Every panel that is found, by name, in the order in which the window shows them."""

    def __init__(self, workbench: Workbench) -> None:
        super().__init__({panel.name: panel(workbench) for panel in find_panels()})
        for panel in self.values():
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

    def tell(self, event: str, *values: Any) -> None:
        """Call the method of an event, such as ``scene_changed``, of every panel."""
        for panel in self.values():
            getattr(panel, event)(*values)

    def tell_growth(self, growth: RecordGrowth) -> None:
        """Tell of new pings, and of another plan if they are traced by one."""
        simulation = growth.answer.simulation
        replanned = growth.current and simulation is not self._planned
        if replanned:
            self._planned = simulation
        for panel in self.values():
            if replanned:
                panel.plan_made(simulation.plan)
            panel.record_grown(growth)
