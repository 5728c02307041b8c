"""Error panel: estimated errors of the ping under the mouse and of the record on screen, in the status bar."""

from insonify_viewer.panels.error.controller import ErrorPanel

PANEL = ErrorPanel
