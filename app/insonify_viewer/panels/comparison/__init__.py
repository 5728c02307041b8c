"""Comparison panel: record A beside the live record B, and how much or how little they differ."""

from __future__ import annotations

from insonify_viewer.panels.comparison.controller import ComparisonPanel

PANEL = ComparisonPanel
