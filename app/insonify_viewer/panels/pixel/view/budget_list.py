"""Budget of a pixel as a list: terms in dB, what returns the echo, what hides the bed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QColor, QResizeEvent
from PySide6.QtWidgets import QHeaderView, QTreeWidget, QTreeWidgetItem, QTreeWidgetItemIterator, QWidget

from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.widgets.text_scale import scaled
from insonify_viewer.widgets.theme import ACCENT

if TYPE_CHECKING:
    from insonify.explanation.pixel import PixelExplanation

MOST = 6  # contributions, and what hides, that are listed
LEVEL, NAME, DETAIL = 0, 1, 2  # columns
NARROW = 205  # px, which hold levels and names
WIDE = 330  # px at the usual size of the text, from which on details have a column; else they are in the tips of names

Row = tuple[str, str, str]


class BudgetList(QTreeWidget):
    """Lists the budget of a pixel."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("budget")
        self.setAccessibleName("Budget of the pixel")
        self.setColumnCount(3)
        self.setHeaderHidden(True)
        self.setIndentation(10)
        self.setRootIsDecorated(False)
        self.setUniformRowHeights(True)
        self.setToolTip("Terms in decibels that add up to the level of the pixel")
        self.setMinimumWidth(NARROW)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.header().setSectionResizeMode(LEVEL, QHeaderView.ResizeMode.ResizeToContents)
        self._give_details_room()

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Give details a column where the list is wide enough."""
        super().resizeEvent(event)
        self._give_details_room()

    @guard_override(None)
    def changeEvent(self, event: QEvent) -> None:
        """Show headings in the accent of the theme."""
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            for k in range(self.topLevelItemCount()):
                self._colour_heading(self.topLevelItem(k))

    def show_explanation(self, explanation: PixelExplanation) -> None:
        """List the budget of a pixel."""
        self.clear()
        terms = [(term.name, _level(term.decibels), term.detail) for term in explanation.terms]
        self._add_group("pixel", _level(explanation.level), "the sum of" if terms else "", terms)
        self._add_group("returned by", "", "", _contributions(explanation))
        self._add_group("hidden by", "", "", _obstructions(explanation))
        for said in explanation.approximations:
            QTreeWidgetItem(self, [said]).setFirstColumnSpanned(True)
        self.expandAll()

    def rows(self) -> list[Row]:
        """Name, level and detail of all rows, each group before its own."""
        found: list[Row] = []
        iterator = QTreeWidgetItemIterator(self)
        while (item := iterator.value()) is not None:
            found.append((item.text(NAME), item.text(LEVEL), item.text(DETAIL)))
            iterator += 1
        return found

    def _add_group(self, name: str, level: str, detail: str, rows: Iterable[Row]) -> None:
        """Add a heading with its rows; one without level and rows is left out."""
        rows = list(rows)
        if not rows and not level:
            return
        group = QTreeWidgetItem(self, [level, name, detail])
        self._colour_heading(group)
        own = [QTreeWidgetItem(group, [level, name, detail]) for name, level, detail in rows]
        for row in (group, *own):
            row.setTextAlignment(LEVEL, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            tip = ": ".join(filter(None, (row.text(NAME), row.text(DETAIL))))
            for column in (NAME, DETAIL):
                row.setToolTip(column, tip)

    def _give_details_room(self) -> None:
        wide = self.viewport().width() >= scaled(self, WIDE)
        modes = QHeaderView.ResizeMode
        self.setColumnHidden(DETAIL, not wide)
        self.header().setStretchLastSection(wide)
        self.header().setSectionResizeMode(NAME, modes.ResizeToContents if wide else modes.Stretch)

    def _colour_heading(self, heading: QTreeWidgetItem | None) -> None:
        if heading is not None and heading.text(NAME):
            heading.setForeground(NAME, QColor(ACCENT))


def _contributions(explanation: PixelExplanation) -> list[Row]:
    return [
        (each.words, f"{100.0 * each.share:.1f} %", f"at {each.ground_range:.1f} m, incidence {each.incidence:.0f}°")
        for each in explanation.contributions[:MOST]
    ]


def _obstructions(explanation: PixelExplanation) -> list[Row]:
    """List what hides the bed, and the level that the pixel would have if nothing did."""
    hiders = [
        (
            each.hider,
            f"{100.0 * each.share:.1f} %",
            "a slope that faces away" if each.faces_away else f"at {each.ground_range:.1f} m",
        )
        for each in explanation.obstructions[:MOST]
    ]
    return [*hiders, ("with nothing hidden", _level(explanation.unhidden), "")] if hiders else []


def _level(level: float) -> str:
    """Level with a true minus sign; no echo has none."""
    if not math.isfinite(level):
        return "no echo"
    return f"{round(level, 2) + 0.0:.2f} dB".replace("-", "−")
