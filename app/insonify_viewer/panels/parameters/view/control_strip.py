"""A few fields side by side in large type, for the strip of a lecture."""

from collections.abc import Iterable, Sequence
from itertools import islice
from typing import Any

from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QWidget

from insonify_viewer.state.fields import ChoiceField, NumberField, Parameter
from insonify_viewer.widgets.buttons import light
from insonify_viewer.widgets.field_rows import Change, ChoiceRow, NumberRow
from insonify_viewer.widgets.layouts import fill
from insonify_viewer.widgets.theme import lecture_scale, scaled

MOST = 5
WIDEST = 16777215  # Qt's largest size of a widget, for no limit
APART, WIDE = 24, 480  # px: between fields, and the greatest width of one at the usual size of the text


class ControlStrip(QWidget):
    """Shows up to `MOST` fields: name and value above a slider, or a list of choices."""

    def __init__(self, dragged: Change, settled: Change) -> None:
        super().__init__()
        self._dragged, self._settled = dragged, settled
        self._structure: tuple[object, ...] = ()
        self.rows: dict[str, Any] = {}  # a `NumberRow` or `ChoiceRow` by its path
        self._cells: list[QWidget] = []
        self._line = fill(QHBoxLayout(self), margins=(8, 0, 8, 0), spacing=APART)
        self._line.addStretch()

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

    def _build(self, fields: Sequence[NumberField | ChoiceField]) -> None:
        for cell in self._cells:
            cell.hide()
            cell.deleteLater()
        self._cells, self.rows = [], {}
        for field in fields:
            cell = QWidget()
            grid = QGridLayout(cell)
            grid.setContentsMargins(0, 0, 0, 0)
            row: NumberRow | ChoiceRow
            if isinstance(field, NumberField):
                row = number = NumberRow(field, self._dragged, self._settled)
                grid.addWidget(number.field, 0, 1)
                grid.addWidget(number.slider, 1, 0, 1, 2)
                number.field.setFixedWidth(round(lecture_scale(self) * number.field.width()))
            else:
                row = choice = ChoiceRow(field, self._settled)
                grid.addWidget(choice.combo, 1, 0)
            grid.addWidget(row.label, 0, 0)
            row.label.setWordWrap(False)
            row.label.setMinimumWidth(0)
            row.label.setMaximumWidth(WIDEST)
            grid.setColumnStretch(0, 1)
            self.rows[field.path] = row
            self._cells.append(cell)
            cell.setMaximumWidth(scaled(self, WIDE))
            self._line.insertWidget(len(self._cells) - 1, cell, 1)
