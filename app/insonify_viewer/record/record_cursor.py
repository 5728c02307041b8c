"""Cursor of a record, which keys move from bin to bin and from ping to ping."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import QPoint, QRect

from insonify_viewer.state.session import Mark


class RecordCursor:
    """A place of the plot, from where the mouse last was; it follows its bin when the record is zoomed or moves."""

    def __init__(
        self,
        plot: Callable[[], QRect],
        mark_at: Callable[[QPoint], Mark | None],
        place_of: Callable[[Mark], QPoint],
    ) -> None:
        self._plot, self._mark_at, self._place_of = plot, mark_at, place_of
        self._place = QPoint(-1, -1)
        self._mark: Mark | None = None

    @property
    def place(self) -> QPoint:
        """Position in the view; the middle of the plot where the cursor was left out of sight."""
        if self._plot().contains(self._place) and self._mark_at(self._place) == self._mark:
            return self._place
        moved = self._place if self._mark is None else self._place_of(self._mark)
        return moved if self._plot().contains(moved) else self._plot().center()

    def put(self, place: QPoint) -> None:
        """Put the cursor at a position of the view."""
        self._place, self._mark = place, self._mark_at(place)

    def step(self, across: int, down: int) -> bool:
        """Go to the nearest place of another bin in a direction; return whether the plot has one."""
        place = self.place
        here, plot = self._mark_at(place), self._plot()
        there = place + QPoint(across, down)
        while here is not None and plot.contains(there) and self._mark_at(there) == here:
            there += QPoint(across, down)
        inside = plot.contains(there)
        self.put(there if inside else place)
        return inside
