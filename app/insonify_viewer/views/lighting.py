"""Widgets that a lesson speaks of, lit in the colours of the style sheet."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget


def light(widget: QWidget, lit: bool) -> None:
    """Light a widget, or let it be as usual."""
    if bool(widget.property("lit")) != lit:
        widget.setProperty("lit", lit)
        # A style sheet reads a property only when the widget is polished.
        widget.style().unpolish(widget)
        widget.style().polish(widget)
