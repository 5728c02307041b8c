"""Comparison panel: record A beside the live record B, and how much or how little they differ."""

from insonify_viewer.panels.comparison.controller import ComparisonPanel

PANEL = ComparisonPanel
