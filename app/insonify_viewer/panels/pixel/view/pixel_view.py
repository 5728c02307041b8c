"""Summary and budget of a pixel beside its cross-section."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QSplitter, QVBoxLayout, QWidget

from insonify_viewer.panels.pixel.view.budget_list import BudgetList
from insonify_viewer.panels.pixel.view.section_view import SectionView
from insonify_viewer.state.session import Mark

if TYPE_CHECKING:
    from insonify.explanation.cross_section import CrossSection
    from insonify.explanation.pixel import PixelExplanation

HINT = "Click a pixel of the record to explain it. Click a place in the 3-D view to light up the pixels that hear it."
SIDES = ("port", "starboard")


class PixelView(QWidget):
    """Shows the explanation of a pixel."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("panel")
        self.summary = QLabel(HINT)
        self.summary.setWordWrap(True)
        self.summary.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.budget, self.section = BudgetList(), SectionView()
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(self.budget)
        splitter.addWidget(self.section)
        splitter.setSizes([430, 570])
        splitter.setChildrenCollapsible(False)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 4, 6, 4)
        layout.setSpacing(3)
        layout.addWidget(self.summary)
        layout.addWidget(splitter, 1)

    def show_nothing(self) -> None:
        """Show that no pixel is pinned."""
        self.summary.setText(HINT)
        self.budget.clear()
        self.section.show_section(None, None)

    def show_waiting(self, mark: Mark) -> None:
        """Show that a pixel is being explained."""
        self.summary.setText(f"explaining ping {mark.ping}, {SIDES[mark.side]} …")

    def show_pixel(self, explanation: PixelExplanation, section: CrossSection) -> None:
        """Show the explanation of a pixel."""
        where = f"ping {explanation.ping}, {SIDES[explanation.side]}, {explanation.slant_range:.2f} m"
        self.summary.setText(f"{where}: {explanation.summary}")
        self.budget.show_explanation(explanation)
        self.section.show_section(explanation, section)
