"""Chart panel: measured speed against measured accuracy of every method on the current scene."""

from insonify_viewer.panels.chart.controller import ChartPanel

PANEL = ChartPanel
