"""Lengths in proportion to the size of the text."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget

USUAL_LINE = 14  # px, height of a line of text for which lengths in pixels are given


def text_scale(widget: QWidget) -> float:
    """Height of a line of a widget's text over the usual one."""
    return widget.fontMetrics().height() / USUAL_LINE


def scaled(widget: QWidget, pixels: int) -> int:
    """Length that holds as many letters of a widget as a length in pixels holds of the usual ones."""
    return round(pixels * text_scale(widget))
