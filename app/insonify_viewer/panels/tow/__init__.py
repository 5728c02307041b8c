"""Tow panel: steering by keys, the live tow for survey programs, and survey exercises."""

from insonify_viewer.panels.tow.controller import TowPanel

PANEL = TowPanel
