"""Column of widgets at a side of the window that scrolls down, and boxes in it that fold."""

from typing import ClassVar

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from insonify_viewer.widgets.buttons import make
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.theme import scaled


class ScrollColumn(QScrollArea):
    """A column of widgets that scrolls down and, by itself, never sideways."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.body = make(QWidget, objectName="panel")
        self.column = QVBoxLayout(self.body)
        self.setWidget(self.body)


class SidePanel(ScrollColumn):
    """A column at a side of the window that scrolls sideways where large text leaves no room for its rows."""

    narrowest: ClassVar[int] = 292  # px, least width, and that of the rows at the usual size of the text

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        wanted = scaled(self, self.narrowest)
        self.setMinimumWidth(min(wanted, self.narrowest))
        self.body.setMinimumWidth(wanted - self.verticalScrollBar().sizeHint().width())
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        fill(self.column, margins=(8, 8, 8, 8), spacing=6)


class FoldingBox(QWidget):
    """A heading, with a widget beside it or none, and a body that it hides or shows."""

    def __init__(self, title: str, body: QWidget, *, unfolded: bool, beside: QWidget | None = None) -> None:
        super().__init__()
        both = Qt.ToolButtonStyle.ToolButtonTextBesideIcon
        self._heading = make(QToolButton, objectName="heading", toolButtonStyle=both, checkable=True, checked=unfolded)
        self.entitle(title)
        self._heading.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self._heading.toggled.connect(self._fold)
        self._body = body
        top = fill(QHBoxLayout(), self._heading, *([] if beside is None else [beside]), spacing=3)
        fill(QVBoxLayout(self), top, body, margins=(0, 0, 0, 0), spacing=0)
        self._fold(unfolded)

    @property
    def unfolded(self) -> bool:
        """Whether the body shows."""
        return self._heading.isChecked()

    def unfold(self, unfolded: bool) -> None:
        """Show or hide the body."""
        self._heading.setChecked(unfolded)

    def entitle(self, title: str) -> None:
        """Change the heading."""
        self._heading.setText(title)
        self._heading.setToolTip(f"Show or hide “{title}”")

    def _fold(self, unfolded: bool) -> None:
        self._body.setVisible(unfolded)
        self._heading.setArrowType(Qt.ArrowType.DownArrow if unfolded else Qt.ArrowType.RightArrow)
