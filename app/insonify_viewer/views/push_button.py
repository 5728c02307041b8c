"""Push buttons of panels and windows beside the record."""

from __future__ import annotations

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QPushButton, QSizePolicy


def push_button(text: str, tip: str, *, style: str = "tool", wide: bool = False) -> QPushButton:
    """Make a button that the Tab key reaches; a click leaves the keyboard where it is.

    Parameters
    ----------
    text, tip : str
        On the button, and in its tooltip.
    style : str
        ``tool``, ``file`` or ``small``, as the style sheet names them.
    wide : bool
        Whether it takes all the width there is.
    """
    button = QPushButton(text)
    button.setObjectName(style)
    button.setToolTip(tip)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    if wide:
        button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
    return button
