"""A few fields in large type, for the strip of a lecture."""

from collections.abc import Iterable, Sequence
from itertools import chain, islice
from typing import Any

from PySide6.QtGui import QFont, QFontMetrics, QResizeEvent
from PySide6.QtWidgets import QGridLayout, QSizePolicy, QWidget

from insonify_viewer.errors import guard_override
from insonify_viewer.state.fields import ChoiceField, NumberField, Parameter
from insonify_viewer.widgets.buttons import light
from insonify_viewer.widgets.field_rows import LONGEST, Change, ChoiceRow, NumberRow
from insonify_viewer.widgets.layouts import fill_grid
from insonify_viewer.widgets.theme import lecture_scale

MOST, ROWS = 5, 2
WIDEST = 16777215  # Qt's largest size of a widget, for no limit
APART = 24  # px, between fields
FRAME = 18  # px, of margins and borders about a name or a value
SMALLER = 1.0, 0.85, 0.7, 0.6, 0.5, 0.4  # sizes of the text over that of a lecture, until all fields fit


class ControlStrip(QWidget):
    """Shows up to `MOST` fields, name and value above a slider or a list of choices, in at most `ROWS` rows.

    Names and values are whole at every width: the text becomes smaller, down to its usual size, then fields are fewer.
    """

    def __init__(self, dragged: Change, settled: Change) -> None:
        super().__init__()
        self._dragged, self._settled = dragged, settled
        self._structure: tuple[object, ...] = ()
        self.rows: dict[str, Any] = {}  # a `NumberRow` or `ChoiceRow` by its path
        self._cells: list[QWidget] = []
        self._grid = fill_grid(QGridLayout(self), (), 1, margins=(8, 0, 8, 0))
        self._grid.setHorizontalSpacing(APART)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)

    def show_fields(self, fields: Iterable[Parameter], lit: Sequence[str] = ()) -> None:
        """Show the first fields with a number or a choice, and light some of them by their paths."""
        shown = list(islice((field for field in fields if isinstance(field, (NumberField, ChoiceField))), MOST))
        structure = tuple((field.path, field.label, getattr(field, "options", ())) for field in shown)
        if structure != self._structure:
            self._structure = structure
            self._build(shown)
        for field in shown:
            row = self.rows[field.path]
            row.show_value(field)
            light(row.label, field.path in lit)

    @guard_override(None)
    def resizeEvent(self, event: QResizeEvent) -> None:
        """Arrange the fields for another width."""
        super().resizeEvent(event)
        self._arrange()

    def _build(self, fields: Sequence[NumberField | ChoiceField]) -> None:
        for cell in self._cells:
            cell.hide()
            cell.deleteLater()
        self._cells, self.rows = [], {}
        for field in fields:
            cell = QWidget()
            row: NumberRow | ChoiceRow
            if isinstance(field, NumberField):
                row = number = NumberRow(field, self._dragged, self._settled)
                lines: list[list[QWidget]] = [[row.label, number.field], [number.slider]]
            else:
                row = choice = ChoiceRow(field, self._settled)
                lines = [[row.label], [choice.combo]]
            fill_grid(QGridLayout(cell), lines, 2, margins=(0, 0, 0, 0)).setColumnStretch(0, 1)
            row.label.setWordWrap(False)
            row.label.setMinimumWidth(0)
            row.label.setMaximumWidth(WIDEST)
            self.rows[field.path] = row
            self._cells.append(cell)
        self._arrange()

    def _arrange(self) -> None:
        """Lay out as many fields as fit, in the largest type in which most of them do."""
        if not self._cells:
            return
        columns, metrics = self._fit()
        for row in self.rows.values():
            if isinstance(row, NumberRow):
                row.field.setFixedWidth(metrics.horizontalAdvance(LONGEST) + FRAME)
        for k, cell in enumerate(self._cells):
            self._grid.addWidget(cell, k // columns, k % columns)
            cell.setVisible(k < columns * ROWS)
        for k in range(MOST):
            self._grid.setColumnStretch(k, int(k < columns))
        self.updateGeometry()

    def _fit(self) -> tuple[int, QFontMetrics]:
        """Set the size of the text; return the number of columns that it allows, and its metrics."""
        font, usual = QFont(self.font()), self.font().pointSizeF()
        columns, metrics = 1, self.fontMetrics()
        for smaller in SMALLER:
            font.setPointSizeF(max(usual, usual * lecture_scale(self) * smaller))
            metrics = QFontMetrics(font)
            widest = max(_width(row, metrics) for row in self.rows.values())
            columns = min(max((self.width() + APART - 16) // (widest + APART), 1), len(self._cells))
            if columns * ROWS >= len(self._cells):
                break
        self.setStyleSheet(f"QLabel, QLineEdit, QComboBox {{ font-size: {font.pointSizeF():g}pt; }}")
        return columns, metrics


def _width(row: NumberRow | ChoiceRow, metrics: QFontMetrics) -> int:
    """Width that a field needs to show its whole name and value."""
    name = metrics.horizontalAdvance(row.label.text()) + FRAME
    if isinstance(row, NumberRow):
        return name + metrics.horizontalAdvance(LONGEST) + FRAME
    options = (row.combo.itemText(k) for k in range(row.combo.count()))
    return max(chain([name], (metrics.horizontalAdvance(option) + 3 * metrics.height() for option in options)))
