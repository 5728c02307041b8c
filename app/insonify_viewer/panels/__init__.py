"""Panels of the window: one folder each, with a controller and a view.

A folder's ``__init__.py`` names its class, which derives from `insonify_viewer.panels.panel.Panel`, as ``PANEL``. Its
module ``controller`` decides what is shown; its module or package ``view`` holds the widgets, and nothing else of it
imports Qt. Folders are found by being here. Installed packages announce a panel class as an entry point of the group
``insonify.panels``.
"""

from typing import Any

from insonify.plugins import announced, loaded, modules_in

GROUP = "insonify.panels"


def find_panels() -> list[Any]:
    """Find the classes of all panels, in the order in which the window shows them."""
    found = [module.PANEL for module in modules_in(__name__) if hasattr(module, "PANEL")]
    ranked = [(panel.rank, panel.name, panel) for panel in found]
    ranked += loaded(announced(GROUP), lambda panel: (panel.rank, panel.name, panel))
    return [panel for *_, panel in sorted(ranked, key=lambda each: each[:2])]
