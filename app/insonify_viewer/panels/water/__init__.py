"""Water panel: sound speed over depth, and the rays that it bends."""

from insonify_viewer.panels.water.controller import WaterPanel

PANEL = WaterPanel
