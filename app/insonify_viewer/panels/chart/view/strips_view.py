"""Three strips on one scale of slant range: a record, its reference, their difference."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from insonify.display.picture import PALETTES, choose_contrast, colour_rows, load_palette
from insonify_viewer.errors.guarded_overrides import guard_override
from insonify_viewer.panels.chart.chart_details import RowDetails
from insonify_viewer.widgets.pixels import colour_table, column_means, round_steps
from insonify_viewer.widgets.theme import ACCENT, EDGE, GROUND, MARK, QUIET, TEXT
from insonify_viewer.widgets.two_sided_palette import two_sided_table

LEFT, RIGHT, TITLE, RULER = 12, 12, 18, 28  # px
LARGE = 0.5  # of the span of the palette: the difference drawn in full colour


class StripsView(QWidget):
    """Shows the record behind a point of a chart."""

    def __init__(self) -> None:
        super().__init__()
        self.setMinimumHeight(3 * (TITLE + 16) + RULER)
        self._details: RowDetails | None = None

    def show_details(self, details: RowDetails) -> None:
        """Show a record beside its reference."""
        self._details = details
        self.update()

    @guard_override(None)
    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw the strips with their titles, and the ruler."""
        del event
        with QPainter(self) as painter:
            painter.fillRect(self.rect(), QColor(GROUND))
            if (details := self._details) is not None:
                low, high = choose_contrast(details.reference)
                shades = colour_table(load_palette(PALETTES[0]))
                largest = LARGE * (high - low)
                for number, (title, strip, ends, table) in enumerate(
                    (
                        (
                            ((f"record: {details.row.method}, {details.row.setting}", TEXT),),
                            details.record,
                            (low, high),
                            shades,
                        ),
                        (((f"reference: {details.rays:,} rays a side", TEXT),), details.reference, (low, high), shades),
                        (
                            (
                                ("difference, full colour at half the picture's span: ", TEXT),
                                ("too bright", ACCENT),
                                (" or ", TEXT),
                                ("too dark", MARK),
                            ),
                            details.record - details.reference,
                            (-largest, largest),
                            two_sided_table(),
                        ),
                    )
                ):
                    self._draw(painter, number, title, strip, ends, table)
                self._draw_ruler(painter, details.reach)

    def _draw(
        self,
        painter: QPainter,
        number: int,
        title: tuple[tuple[str, QColor], ...],
        strip: NDArray[np.float32],
        ends: tuple[float, float],
        table: NDArray[np.uint32],
    ) -> None:
        place = self._place(number)
        line = place.adjusted(0, -TITLE, 0, 0)
        for words, colour in title:
            painter.setPen(QColor(colour))
            painter.drawText(line, Qt.AlignmentFlag.AlignLeft, words)
            line.setLeft(line.left() + painter.fontMetrics().horizontalAdvance(words))
        pixels = colour_rows(column_means(strip, place.width()), *ends, table)
        rows, width = pixels.shape
        painter.drawImage(place, QImage(pixels.data, width, rows, 4 * width, QImage.Format.Format_RGB32))

    def _place(self, number: int) -> QRect:
        """Rectangle of a strip."""
        tall = (self.height() - RULER) / 3.0
        top = round(number * tall) + TITLE
        return QRect(LEFT, top, max(self.width() - LEFT - RIGHT, 2), max(round((number + 1) * tall) - top - 2, 1))

    def _draw_ruler(self, painter: QPainter, reach: float) -> None:
        """Draw metres of slant range from nadir to both sides."""
        last = self._place(2)
        middle, base = last.left() + last.width() / 2.0, last.bottom() + 2
        for value in round_steps(0.0, reach, max(last.width() // 160, 1)):
            for x in {middle - value / reach * last.width() / 2.0, middle + value / reach * last.width() / 2.0}:
                painter.setPen(QColor(EDGE))
                painter.drawLine(int(x), base, int(x), base + 4)
                painter.setPen(QColor(QUIET))
                unit = " m" if value == 0.0 else ""
                painter.drawText(
                    QRect(int(x) - 40, base + 5, 80, 15), Qt.AlignmentFlag.AlignHCenter, f"{value:g}{unit}"
                )
