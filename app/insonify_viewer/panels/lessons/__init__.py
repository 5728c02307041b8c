"""Lessons panel: what to move step by step, and what to see."""

from insonify_viewer.panels.lessons.controller import LessonsPanel

PANEL = LessonsPanel
