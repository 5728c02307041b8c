"""Rows, columns, grids and splitters that are filled in one call."""

from collections.abc import Iterable, Sequence
from typing import TypeVar

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QLayout, QSplitter, QWidget

Box = TypeVar("Box", bound=QBoxLayout)
Margins = tuple[int, int, int, int]  # px: left, top, right, bottom


def fill(
    box: Box,
    *parts: QWidget | QLayout | None,
    growing: QWidget | None = None,
    margins: Margins | None = None,
    spacing: int | None = None,
) -> Box:
    """Put parts into a row or a column, None for free room; the growing one takes the room that is left."""
    if margins is not None:
        box.setContentsMargins(*margins)
    if spacing is not None:
        box.setSpacing(spacing)
    for part in parts:
        if part is None:
            box.addStretch(1)
        elif isinstance(part, QLayout):
            box.addLayout(part)
        else:
            box.addWidget(part, int(part is growing))
    return box


def fill_grid(
    grid: QGridLayout, rows: Iterable[Sequence[QWidget]], columns: int, first: int = 0, margins: Margins | None = None
) -> QGridLayout:
    """Put rows of parts into a grid, from its first row on; the last part of each reaches to the last column."""
    if margins is not None:
        grid.setContentsMargins(*margins)
    for row, parts in enumerate(rows, first):
        for column, part in enumerate(parts, 1):
            grid.addWidget(part, row, column - 1, 1, 1 if column < len(parts) else columns - column + 1)
    return grid


def make_splitter(way: Qt.Orientation, *parts: QWidget, sizes: tuple[int, ...] = ()) -> QSplitter:
    """Put parts side by side or one below the other, with a line to drag; none of them can be dragged shut."""
    splitter = QSplitter(way)
    for part in parts:
        splitter.addWidget(part)
    splitter.setChildrenCollapsible(False)
    if sizes:
        splitter.setSizes(sizes)
    return splitter
