"""Terms of the sonar equation in groups, beside the curves of the levels over slant range."""

import html
from collections.abc import Iterable

import numpy as np
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QDoubleSpinBox, QHBoxLayout, QVBoxLayout, QWidget

from insonify.arrays import Floats, Integers
from insonify_viewer.panels.budget.levels import Group, SolvedBudget, signed
from insonify_viewer.widgets.arrow_keys import steps_of
from insonify_viewer.widgets.buttons import make, make_label
from insonify_viewer.widgets.layouts import fill, make_splitter
from insonify_viewer.widgets.painting import PaintedOnce, make_polyline, round_steps
from insonify_viewer.widgets.text import ThemedText
from insonify_viewer.widgets.theme import ACCENT, EDGE, MARK, QUIET, RAISED, TEXT, TRAIL, text_scale

HINT = "Move over the record, or over the curves, to see the terms at another range."
LEFT, RIGHT, TOP, BOTTOM = 44.0, 10.0, 22.0, 32.0  # px around the plot
NARROWEST = 240  # px, which hold a group of terms
SPAN, STEP = 100.0, 10.0  # dB, the most that the plot shows, and what its limits are multiples of
NEAREST = 0.15  # share of the range, nearer than which levels do not set the scale
KEY = 36.0  # px, piece of line before the name of a curve, and the gap behind it
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
        self._target = make(QDoubleSpinBox, **decibels, keyboardTracking=False, accessibleName="Target strength")
        self._target.setToolTip("Target strength of the target, re 1 m² (dB; −60 to 60 dB)")
        self._target.valueChanged.connect(self.targeted)
        self.terms, self.curves = TermList(), LevelCurves()
        self.curves.ranged.connect(self.ranged)
        self._solved: SolvedBudget | None = None
        self._lay_out()

    @property
    def target_strength(self) -> float:
        """Target strength in dB re 1 m²."""
        return self._target.value()

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
        top = fill(QHBoxLayout(), self.sentence, label, self._target, growing=self.sentence)
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


class LevelCurves(PaintedOnce):
    """Paints levels over slant range, and signals the range under the mouse; arrow keys move it."""

    ranged = Signal(float)

    def __init__(self) -> None:
        super().__init__(minimumSize=QSize(240, 130), mouseTracking=True, focusPolicy=Qt.FocusPolicy.TabFocus)
        self.setAccessibleName("Levels over slant range")
        self.setToolTip(
            "Levels of bed, target and noise before the gain. Move the mouse or press ← → to choose a range"
        )
        self._solved: SolvedBudget | None = None
        self._range = 0.0

    @property
    def area(self) -> QRectF:
        """The plot, px."""
        large = text_scale(self)
        left, top, bottom = LEFT * large, TOP * large, BOTTOM * large
        return QRectF(left, top, max(self.width() - left - RIGHT, 1.0), max(self.height() - top - bottom, 1.0))

    def show_levels(self, solved: SolvedBudget | None) -> None:
        """Show the levels of a scene; None clears them."""
        self._solved = solved
        self.paint_anew()

    def show_range(self, slant_range: float) -> None:
        """Show the cursor at a slant range in metres."""
        self._range = slant_range
        self.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the curves, which are painted once, and the cursor."""
        super().paint(painter)
        if self._solved is not None:
            area = self.area
            x = area.left() + self._range / self._solved.scene.sonar.range * area.width()
            painter.setPen(QPen(QColor(TEXT), 1.0, Qt.PenStyle.DotLine))
            painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Signal the range under the mouse."""
        if self._solved is not None:
            share = (event.position().x() - self.area.left()) / self.area.width()
            self._move(share * self._solved.scene.sonar.range)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Signal a range next to the present one."""
        steps = steps_of(event)
        if self._solved is None or steps is None or not steps[0]:
            super().keyPressEvent(event)
            return
        self._move(self._range + steps[0] * KEY_STEP * self._solved.scene.sonar.range)

    def paint_picture(self, painter: QPainter) -> None:
        """Paint scales, curves and their names."""
        if self._solved is None:
            return
        area, reach, solved = self.area, self._solved.scene.sonar.range, self._solved.record
        levels = [(solved.bed, QPen(QColor(ACCENT), 1.6)), (solved.target, QPen(QColor(MARK), 1.6))]
        styles = (Qt.PenStyle.SolidLine, Qt.PenStyle.DashLine, Qt.PenStyle.DotLine)
        for level, style in zip(solved.disturbances, styles):
            levels.append((level, QPen(QColor(QUIET if level.name == "noise" else TRAIL), 1.6, style)))
        low, high = _limits(solved.slant_range, [level.decibels for level, _ in levels])
        painter.fillRect(area, QColor(RAISED))
        _paint_scales(painter, area, reach, (low, high), text_scale(self))
        self._paint_words(painter, area)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        columns = np.unique(
            np.linspace(0, solved.slant_range.size - 1, max(int(2.0 * area.width()), 2)).astype(np.int64)
        )
        x = area.left() + solved.slant_range[columns] / reach * area.width()
        painter.setClipRect(area)
        for level, pen in levels:
            painter.setPen(pen)
            for part in _runs(level.decibels[columns]):
                y = area.bottom() - (level.decibels[columns][part] - low) / (high - low) * area.height()
                painter.drawPolyline(make_polyline(x[part], np.clip(y, area.top() - 1e3, area.bottom() + 1e3)))
        painter.setClipping(False)
        self._paint_names(painter, area, [(level.name, pen) for level, pen in levels])

    def _paint_words(self, painter: QPainter, area: QRectF) -> None:
        """Write what the scales are."""
        assert self._solved is not None
        painter.setPen(QColor(QUIET))
        tall = painter.fontMetrics().height()
        below = QRectF(area.left(), self.height() - tall, area.width(), tall)
        words = f"slant range (m) · level before the gain ({self._solved.unit})"
        painter.drawText(below, Qt.AlignmentFlag.AlignCenter, words)

    def _paint_names(self, painter: QPainter, area: QRectF, names: list[tuple[str, QPen]]) -> None:
        """Write the names of the curves above the plot, each behind a piece of its line."""
        widths = [painter.fontMetrics().horizontalAdvance(name) for name, _ in names]
        if sum(widths) + len(names) * KEY > area.width():
            names = [(name.removesuffix(" reverberation"), pen) for name, pen in names]
        x, middle = area.left(), 0.5 * area.top()
        for name, pen in names:
            painter.setPen(pen)
            painter.drawLine(QPointF(x, middle), QPointF(x + 0.5 * KEY, middle))
            painter.setPen(QColor(TEXT))
            wide = painter.fontMetrics().horizontalAdvance(name)
            box = QRectF(x + 0.6 * KEY, 0.0, wide + 2.0, area.top())
            painter.drawText(box, Qt.AlignmentFlag.AlignVCenter, name)
            x += wide + KEY

    def _move(self, slant_range: float) -> None:
        assert self._solved is not None
        self.ranged.emit(min(max(slant_range, 0.0), self._solved.scene.sonar.range))


def _limits(slant_range: Floats, levels: list[Floats]) -> tuple[float, float]:
    """Lowest and highest level of the plot."""
    far = slant_range > NEAREST * slant_range[-1]
    shown = np.concatenate([level[far & np.isfinite(level)] for level in levels])
    high = STEP * np.ceil(shown.max(initial=-np.inf) / STEP) if shown.size else 0.0
    low = STEP * np.floor(shown.min(initial=np.inf) / STEP) if shown.size else -SPAN
    return float(max(low, high - SPAN, -1e9)), float(max(high, low + STEP))


def _runs(level: Floats) -> list[Integers]:
    """Find the indices of each stretch in which a level is finite."""
    finite = np.flatnonzero(np.isfinite(level))
    return [part for part in np.split(finite, np.flatnonzero(np.diff(finite) > 1) + 1) if part.size > 1]


def _paint_scales(painter: QPainter, area: QRectF, reach: float, limits: tuple[float, float], large: float) -> None:
    """Paint lines across at round levels and ranges, with their numbers."""
    low, high = limits
    tall = painter.fontMetrics().height()
    right = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
    for level in round_steps(low, high, max(int(area.height() / (20.0 * large)), 2)):
        y = area.bottom() - (level - low) / (high - low) * area.height()
        painter.setPen(QColor(EDGE))
        painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
        painter.setPen(QColor(QUIET))
        box = QRectF(0.0, y - 0.5 * tall, area.left() - 6.0, tall)
        painter.drawText(box, right, f"{level:g}".replace("-", "−"))
    for distance in round_steps(0.0, reach, max(int(area.width() / (60.0 * large)), 2)):
        x = area.left() + distance / reach * area.width()
        painter.setPen(QColor(EDGE))
        painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))
        painter.setPen(QColor(QUIET))
        box = QRectF(x - 40.0, area.bottom() + 1.0, 80.0, tall)
        painter.drawText(box, Qt.AlignmentFlag.AlignHCenter, f"{distance:g}")
