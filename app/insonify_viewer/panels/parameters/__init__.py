"""Parameters panel: every field of the scene with its slider."""

from insonify_viewer.panels.parameters.controller import ParametersPanel

PANEL = ParametersPanel
