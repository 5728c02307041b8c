"""Base of the panels at the sides of the window: a column of widgets that scrolls down."""

from __future__ import annotations

from typing import ClassVar

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QScrollArea, QVBoxLayout, QWidget

from insonify_viewer.widgets.text_scale import scaled


class ScrollColumn(QScrollArea):
    """A column of widgets that scrolls down and, by itself, never sideways."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.body = QWidget()
        self.body.setObjectName("panel")
        self.column = QVBoxLayout(self.body)
        self.setWidget(self.body)


class SidePanel(ScrollColumn):
    """A column at a side of the window, never too narrow for its rows.

    It scrolls sideways where large text leaves no room for its rows in a small window.

    Attributes
    ----------
    narrowest : int
        Least width in pixels, and that of the rows at the usual size of the text.
    """

    narrowest: ClassVar[int] = 292

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        wanted = scaled(self, self.narrowest)
        self.setMinimumWidth(min(wanted, self.narrowest))
        self.body.setMinimumWidth(wanted - self.verticalScrollBar().sizeHint().width())
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        self.column.setContentsMargins(8, 8, 8, 8)
        self.column.setSpacing(6)
