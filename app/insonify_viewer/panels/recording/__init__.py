"""Recording panel: what a recording tells beside the simulated record, and how alike the two are."""

from __future__ import annotations

from insonify_viewer.panels.recording.controller import RecordingPanel

PANEL = RecordingPanel
