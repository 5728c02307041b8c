"""Lessons panel: what to move step by step, and what to see."""

from __future__ import annotations

from insonify_viewer.panels.lessons.controller import LessonsPanel

PANEL = LessonsPanel
