"""Effects as tick boxes, each with what it changes."""

from __future__ import annotations

from collections.abc import Callable

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QCheckBox, QGridLayout, QLabel, QSizePolicy, QWidget

from insonify_viewer.panels.parameters.effect_rows import EffectRow
from insonify_viewer.widgets.folding_box import FoldingBox


class EffectsBox(FoldingBox):
    """One tick box an effect, under a heading that folds."""

    def __init__(self, ticked: Callable[[str, bool], None]) -> None:
        self.ticks: dict[str, QCheckBox] = {}
        self.figures: dict[str, QLabel] = {}
        self._ticked = ticked
        body = QWidget()
        self._grid = QGridLayout(body)
        self._grid.setContentsMargins(6, 4, 6, 4)
        self._grid.setVerticalSpacing(3)
        self._grid.setColumnStretch(1, 1)
        super().__init__("Effects", body, unfolded=True)

    def show_rows(self, rows: tuple[EffectRow, ...]) -> None:
        """Show which effects the scene has, and what each changes."""
        for row in rows:
            if row.name not in self.ticks:
                self._add(row)
            tick, figure = self.ticks[row.name], self.figures[row.name]
            tick.setChecked(row.on)
            figure.setText(row.figure)
            figure.setToolTip(row.explanation)

    def _add(self, row: EffectRow) -> None:
        tick, figure = QCheckBox(row.name), QLabel()
        tick.setToolTip(row.meaning)
        tick.setFocusPolicy(Qt.FocusPolicy.TabFocus)  # a click leaves the keyboard to the record, where Space pauses
        tick.clicked.connect(lambda on, name=row.name: self._ticked(name, on))
        figure.setObjectName("figure")
        figure.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        figure.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        line = len(self.ticks)
        self._grid.addWidget(tick, line, 0)
        self._grid.addWidget(figure, line, 1)
        self.ticks[row.name], self.figures[row.name] = tick, figure
