"""Sonar-equation panel: levels of bed, target and noise line by line at a range, and over range."""

from insonify_viewer.panels.budget.controller import BudgetPanel

PANEL = BudgetPanel
