"""Widgets of the tool bar: a slider that gives way, lists to choose from, and buttons of actions."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QComboBox, QSlider, QToolBar, QToolButton

from insonify_viewer.errors.guarded_overrides import guard_override


class GainSlider(QSlider):
    """Slider that asks for little room and takes what there is."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setMaximumWidth(130)

    @guard_override(QSize())
    def sizeHint(self) -> QSize:
        """Room for the handle and a few steps."""
        return QSize(40, super().sizeHint().height())


def make_combo(entries: Sequence[tuple[str, object]], name: str) -> QComboBox:
    """Make a list of entries (text, data) with a name for screen readers, which is its tooltip too."""
    combo = QComboBox()
    # A click leaves the keyboard focus to the record, where Space pauses.
    combo.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    combo.setToolTip(name)
    combo.setAccessibleName(name)
    for text, data in entries:
        combo.addItem(text, data)
    return combo


def with_key(tip: str, shortcut: QKeySequence) -> str:
    """Append a shortcut to a tooltip, as the system writes it."""
    key = shortcut.toString(QKeySequence.SequenceFormat.NativeText)
    return f"{tip} ({key})" if key else tip


def button_of(bar: QToolBar, action: QAction) -> QToolButton:
    """Return the button of an action in a tool bar."""
    button = bar.widgetForAction(action)
    assert isinstance(button, QToolButton)
    return button
