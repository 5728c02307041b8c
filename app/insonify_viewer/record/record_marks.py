"""Marks over a record: the point under the mouse, the pinned pixel, lit pixels, contacts and a measured line."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from PySide6.QtCore import QPoint, QRect
from PySide6.QtGui import QPainter

from insonify_viewer.record.record_overlays import draw_contacts, draw_cross, draw_measured
from insonify_viewer.state.session import Mark
from insonify_viewer.widgets.pixel_marks import draw_lit, draw_pin


@dataclass
class RecordMarks:
    """What is marked in a record, and how it is painted."""

    cross: Mark | None = None  # point under the mouse
    pin: Mark | None = None  # pinned pixel
    lit: tuple[Mark, ...] = ()  # pixels that hear a picked place
    contacts: Sequence[tuple[Mark, str, bool]] = ()  # contacts with their names; True for the chosen one
    line: tuple[Mark, Mark, str] | None = None  # (Mark, Mark, str) ends of a measured line, and its length in words

    @property
    def pointed(self) -> Mark | None:
        """The pinned pixel, else the point under the mouse."""
        return self.pin or self.cross

    def draw(self, painter: QPainter, plot: QRect, place_of: Callable[[Mark], QPoint]) -> None:
        """Paint all marks inside a plot; ``place_of`` finds the place of one."""
        draw_lit(painter, (place for place in map(place_of, self.lit) if plot.contains(place)))
        draw_contacts(painter, plot, ((place_of(mark), name, chosen) for mark, name, chosen in self.contacts))
        for mark, draw in ((self.pin, draw_pin), (self.cross, draw_cross)):
            if mark is not None and plot.contains(place_of(mark)):
                draw(painter, place_of(mark))
        if self.line is not None:
            near, far, words = self.line
            draw_measured(painter, plot, (place_of(near), place_of(far)), words)
