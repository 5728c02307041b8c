"""Line of text in the status bar."""

from __future__ import annotations

from PySide6.QtWidgets import QLabel


class ReadoutView(QLabel):
    """A line of text."""
