"""Terms of the sonar equation in groups, beside the curves of the levels over slant range."""

import html
from collections.abc import Iterable

import numpy as np
from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QVBoxLayout, QWidget

from insonify.arrays import Floats
from insonify_viewer.panels.budget.levels import Group, SolvedBudget, signed
from insonify_viewer.widgets.arrow_keys import steps_of
from insonify_viewer.widgets.buttons import make, make_label
from insonify_viewer.widgets.layouts import fill, make_splitter
from insonify_viewer.widgets.plot import Canvas, Plot
from insonify_viewer.widgets.text import ThemedText
from insonify_viewer.widgets.theme import ACCENT, MARK, QUIET, TEXT, TRAIL

HINT = "Move over the record, or over the curves, to see the terms at another range."
NARROWEST = 240  # px, which hold a group of terms
SPAN, STEP = 100.0, 10.0  # dB, the most that the plot shows, and what its limits are multiples of
NEAREST = 0.15  # share of the range, nearer than which levels do not set the scale
KEY_STEP = 0.01  # of the range, by which a key moves the cursor
STRONGEST = 60.0  # dB re 1 m², of a target, up and down


class BudgetView(QWidget):
    """Shows the sonar equation, and signals another target strength or another range."""

    targeted = Signal(float)  # target strength that the person set, dB re 1 m²
    ranged = Signal(float)  # slant range to which the person moved the cursor of the curves, m

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.sentence, self.model = make_label("choice", HINT), make_label("name")
        decibels = {"minimum": -STRONGEST, "maximum": STRONGEST, "decimals": 1, "value": -20.0, "suffix": " dB"}
        self.target = make(QDoubleSpinBox, **decibels, keyboardTracking=False, accessibleName="Target strength")
        self.target.setToolTip("Target strength of the target, re 1 m² (dB; −60 to 60 dB)")
        self.target.valueChanged.connect(self.targeted)
        self.terms, self.curves = TermList(), LevelCurves()
        self.curves.ranged.connect(self.ranged)
        self._solved: SolvedBudget | None = None
        self._lay_out()

    @property
    def target_strength(self) -> float:
        """Target strength in dB re 1 m²."""
        return self.target.value()

    def show_nothing(self, reason: str) -> None:
        """Show why there are no levels."""
        self._solved = None
        self._say(reason, "")
        self.terms.show_groups(())
        self.curves.show_levels(None)

    def show_levels(self, solved: SolvedBudget) -> None:
        """Show the curves of a scene; the terms follow with `show_range`."""
        self._solved = solved
        self.curves.show_levels(solved)

    def show_range(self, slant_range: float) -> None:
        """Show the terms at a slant range in metres."""
        if self._solved is not None:
            self._say(self._solved.describe(slant_range), self._solved.describe_model(slant_range))
            self.terms.show_groups(self._solved.groups(slant_range))
            self.curves.show_range(slant_range)

    def _say(self, sentence: str, model: str) -> None:
        self.sentence.setText(sentence)
        self.model.setText(model)
        self.model.setVisible(bool(model))

    def _lay_out(self) -> None:
        label = make_label("name", "target")
        label.setWordWrap(False)
        top = fill(QHBoxLayout(), self.sentence, label, self.target, growing=self.sentence)
        splitter = make_splitter(Qt.Orientation.Horizontal, self.terms, self.curves, sizes=(500, 500))
        fill(QVBoxLayout(self), top, self.model, splitter, growing=splitter, margins=(6, 4, 6, 4), spacing=3)


class TermList(ThemedText):
    """Lists groups of terms in two columns, each below the level that it adds up to."""

    def __init__(self) -> None:
        self.groups: tuple[Group, ...] = ()
        tip = "Terms in decibels, below the level that they add up to"
        super().__init__("Terms of the sonar equation", tip, NARROWEST)

    def show_groups(self, groups: Iterable[Group]) -> None:
        """List groups of terms."""
        self.groups = tuple(groups)
        self.write()

    def text(self) -> str:
        """HTML of the two columns."""
        columns = "".join(f'<td style="padding-right:14px">{_table(part)}</td>' for part in _halves(self.groups))
        return f"<table><tr>{columns}</tr></table>"


def _halves(groups: tuple[Group, ...]) -> tuple[tuple[Group, ...], tuple[Group, ...]]:
    """Two columns of groups, of which the longer one is as short as possible."""
    lines = [1 + len(group.rows) for group in groups]
    cut = min(range(len(groups) + 1), key=lambda place: max(sum(lines[:place]), sum(lines[place:])))
    return groups[:cut], groups[cut:]


def _table(groups: tuple[Group, ...]) -> str:
    """Make a table of names and levels."""
    lines = []
    for group in groups:
        lines.append(_line(group.name, "" if group.level is None else signed(group.level), ACCENT))
        lines += [_line(name, signed(level), TEXT) for name, level in group.rows]
    return f'<table cellspacing="2">{"".join(lines)}</table>'


def _line(name: str, level: str, colour: QColor) -> str:
    return (
        f'<tr><td style="white-space:nowrap; color:{colour.name()}">{html.escape(name)}</td>'
        f'<td align="right" style="white-space:nowrap; padding-left:10px">{html.escape(level)}</td></tr>'
    )


class LevelCurves(Plot):
    """Levels over slant range; signals the range under the mouse, and arrow keys move it."""

    ranged = Signal(float)

    def __init__(self) -> None:
        tip = "Levels of bed, target and noise before the gain. Move the mouse or press ← → to choose a range"
        size, focus = QSize(240, 130), Qt.FocusPolicy.TabFocus
        super().__init__("Levels over slant range", tip, minimumSize=size, focusPolicy=focus)
        self._solved: SolvedBudget | None = None
        self._range, self._cursor = 0.0, None
        self.hovered.connect(lambda slant_range, _: self._move(slant_range))

    def show_levels(self, solved: SolvedBudget | None) -> None:
        """Show the levels of a scene; None clears them."""
        self._solved = solved
        if solved is not None:
            self.words = f"slant range (m) · level before the gain ({solved.unit})", ""
        self.redraw()

    def show_range(self, slant_range: float) -> None:
        """Show the cursor at a slant range in metres."""
        self._range = slant_range
        if self._cursor is not None:
            self._cursor.setValue(slant_range)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Signal a range next to the present one."""
        steps = steps_of(event)
        if self._solved is None or steps is None or not steps[0]:
            super().keyPressEvent(event)
            return
        self._move(self._range + steps[0] * KEY_STEP * self._solved.scene.sonar.range)

    def draw(self, canvas: Canvas) -> None:
        """Draw curves, their names and the cursor."""
        self._cursor = None
        if self._solved is None:
            return
        solved, solid = self._solved.record, Qt.PenStyle.SolidLine
        canvas.name_lines()
        levels = [(solved.bed, ACCENT, solid), (solved.target, MARK, solid)]
        for level, style in zip(solved.disturbances, (solid, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine)):
            levels.append((level, QUIET if level.name == "noise" else TRAIL, style))
        for level, colour, style in levels:
            canvas.line(solved.slant_range, level.decibels, colour, 1.6, style=style, name=level.name)
        self.limit(
            (0.0, self._solved.scene.sonar.range),
            _limits(solved.slant_range, [level.decibels for level, *_ in levels]),
        )
        self._cursor = canvas.rule(self._range, TEXT)

    def _move(self, slant_range: float) -> None:
        if self._solved is not None:
            self.ranged.emit(min(max(slant_range, 0.0), self._solved.scene.sonar.range))


def _limits(slant_range: Floats, levels: list[Floats]) -> tuple[float, float]:
    """Lowest and highest level of the plot."""
    far = slant_range > NEAREST * slant_range[-1]
    shown = np.concatenate([level[far & np.isfinite(level)] for level in levels])
    high = STEP * np.ceil(shown.max(initial=-np.inf) / STEP) if shown.size else 0.0
    low = STEP * np.floor(shown.min(initial=np.inf) / STEP) if shown.size else -SPAN
    return float(max(low, high - SPAN, -1e9)), float(max(high, low + STEP))
