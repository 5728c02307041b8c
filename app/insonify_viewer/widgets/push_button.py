"""Push buttons of panels and windows beside the record."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QPushButton, QSizePolicy


def push_button(text: str, tip: str, *, style: str = "tool", wide: bool = False) -> QPushButton:
    """Make a button that the Tab key reaches; a click leaves the keyboard where it is."""
    button = QPushButton(text)
    button.setObjectName(style)
    button.setToolTip(tip)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    if wide:
        button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
    return button
