"""States of widgets that the style sheet knows by properties: lit by a lesson, changed since the scene was opened."""

from __future__ import annotations

from PySide6.QtWidgets import QWidget


def light(widget: QWidget, lit: bool) -> None:
    """Light a widget, or let it be as usual."""
    set_property(widget, "lit", lit)


def set_property(widget: QWidget, name: str, on: bool) -> None:
    """Set a property of a widget by which the style sheet draws it."""
    if bool(widget.property(name)) != on:
        widget.setProperty(name, on)
        # A style sheet reads a property only when the widget is polished.
        widget.style().unpolish(widget)
        widget.style().polish(widget)
