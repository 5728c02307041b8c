"""Readout panel: ranges, bed and intensity at the point of the record under the mouse."""

from __future__ import annotations

from insonify_viewer.panels.readout.controller import ReadoutPanel

PANEL = ReadoutPanel
