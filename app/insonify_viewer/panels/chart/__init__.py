"""Chart panel: measured speed against measured accuracy of every method on the current scene."""

from __future__ import annotations

from insonify_viewer.panels.chart.controller import ChartPanel

PANEL = ChartPanel
