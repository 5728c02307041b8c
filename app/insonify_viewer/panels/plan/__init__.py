"""Plan panel: what is modelled, what is left out, and how to force either."""

from insonify_viewer.panels.plan.controller import PlanPanel

PANEL = PlanPanel
