"""Plan panel: what is modelled, what is left out, and how to force either."""

from __future__ import annotations

from insonify_viewer.panels.plan.controller import PlanPanel

PANEL = PlanPanel
