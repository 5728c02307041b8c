"""Readout panel: ranges, bed and intensity at the point of the record under the mouse."""

from insonify_viewer.panels.readout.controller import ReadoutPanel

PANEL = ReadoutPanel
