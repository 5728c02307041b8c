"""Entries of the plan, modelled or left out, in the words of physics, each with a combo box that forces it."""

import tomllib
from collections.abc import Callable
from functools import cache

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from insonify.files import resources
from insonify.parallel import count_threads
from insonify_viewer.core_types import Plan, PlanEntry
from insonify_viewer.state.fields import NumberField
from insonify_viewer.state.history import Modelling
from insonify_viewer.state.quantities import format_duration
from insonify_viewer.widgets.buttons import light, make_label, push_button
from insonify_viewer.widgets.field_rows import Combo, NumberRow
from insonify_viewer.widgets.layouts import fill, fill_grid
from insonify_viewer.widgets.side_panel import FoldingBox, SidePanel
from insonify_viewer.widgets.text import literal
from insonify_viewer.widgets.theme import scaled

Force = Callable[[str, str | None], None]
AUTOMATIC = "automatic"
TOLERANCES = (0.2, 50.0)  # %


class PlanView(SidePanel):
    """Shows a plan, and signals choices that the person forces."""

    forced = Signal(str, object)  # subject, and a choice or None
    tolerated = Signal(float)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._percent = 3.0  # the tolerance that is shown
        self.tolerance = NumberRow(_number(self._percent), self._drag_tolerance, self._settle_tolerance)
        self.column.addLayout(fill_grid(QGridLayout(), [self.tolerance.parts], 3, margins=(6, 0, 2, 0)))
        self._totals, self._change = make_label("about"), make_label("change")
        tip = "Let the program choose everything again"
        self.automatic = push_button("Back to automatic", tip, style="file", wide=True)
        tip = "Measure speed and error of every method on this scene"
        self.chart = push_button("Chart…", tip, style="file", wide=True)
        buttons = fill(QHBoxLayout(), self.automatic, self.chart)
        self.groups = {True: PlanGroup("Modelled"), False: PlanGroup("Left out")}
        fill(self.column, self._totals, self._change, buttons, *self.groups.values(), None)
        self._predicted = self._on = ""
        self._lit: set[str] = set()
        self.show_change("", "")

    def show_plan(self, plan: Plan, modelling: Modelling) -> None:
        """Show a plan, with its tolerance and forced choices."""
        self._drag_tolerance("", 100.0 * modelling.tolerance)
        self.automatic.setEnabled(bool(modelling.forced))
        threads = count_threads()
        on = "one thread" if threads == 1 else f"{threads} threads"
        cost = format_duration(plan.cost / threads)
        self._predicted, self._on = f"predicted: error {_share(plan.error)}, {cost} a ping on {on}", on
        self._totals.setText(self._predicted)
        forced = dict(modelling.forced)
        for modelled, group in self.groups.items():
            group.show_entries(
                [entry for entry in plan.entries if entry.modelled is modelled], forced, self.forced.emit
            )

        self._light_lines()

    def light(self, subjects: set[str]) -> None:
        """Light the lines of these subjects and no others; the tolerance is one."""
        self._lit = subjects
        self._light_lines()

    def _light_lines(self) -> None:
        light(self.tolerance.label, "tolerance" in self._lit)
        for group in self.groups.values():
            for name, line in group.lines.items():
                line.light(name in self._lit)

    def _drag_tolerance(self, _: str, percent: float) -> None:
        """Show a tolerance in percent; it is final when the slider is released."""
        self._percent = percent
        self.tolerance.show_value(_number(percent))

    def _settle_tolerance(self, path: str, percent: object) -> None:
        """Signal a final tolerance: the number that is given, or the one to which the slider was dragged."""
        value = percent if path else self._percent
        if isinstance(value, (int, float)) and value > 0.0:
            self.tolerated.emit(value / 100.0)
        else:
            self._drag_tolerance("", self._percent)

    def show_measured(self, seconds: float) -> None:
        """Show the measured time of a ping below the predicted one."""
        self._totals.setText(f"{self._predicted}\nmeasured: {format_duration(seconds)} a ping on {self._on}")

    def show_change(self, subject: str, words: str) -> None:
        """Show the effect of the last change; beside its line if one subject changed."""
        lines = {name: line for group in self.groups.values() for name, line in group.lines.items()}
        for name, line in lines.items():
            line.say(words if name == subject else "")
        self._change.setText(words)
        self._change.setVisible(bool(words) and subject not in lines)


class PlanGroup(FoldingBox):
    """The lines of all entries that are modelled, or of all that are left out."""

    def __init__(self, title: str) -> None:
        self.lines: dict[str, PlanLine] = {}
        self._rows = QWidget()
        self._column = fill(QVBoxLayout(self._rows), margins=(6, 4, 2, 4), spacing=8)
        super().__init__(title, self._rows, unfolded=True)
        self.hide()

    def show_entries(self, entries: list[PlanEntry], forced: dict[str, str], force: Force) -> None:
        """Show these entries; keep the lines if the subjects are the same."""
        names = _names(entries)
        if names != list(self.lines):
            for line in self.lines.values():
                self._column.removeWidget(line)
                line.hide()
                line.deleteLater()
            self.lines = {name: PlanLine(force) for name in names}
            for line in self.lines.values():
                self._column.addWidget(line)
        for name, entry in zip(names, entries):
            self.lines[name].show_entry(entry, forced.get(entry.subject))
        self.setVisible(bool(entries))


class PlanLine(QWidget):
    """One entry of the plan."""

    def __init__(self, force: Force) -> None:
        super().__init__()
        self._subject = ""
        self._choice, self._numbers, self._change = (make_label(name) for name in ("choice", "name", "change"))
        self.combo = Combo()
        self.combo.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.combo.setFixedWidth(scaled(self.combo, 104))
        self.combo.activated.connect(lambda _: force(self._subject, self.combo.currentData()))
        rows = (self._choice, self.combo), (self._numbers,), (self._change,)
        grid = fill_grid(QGridLayout(self), rows, 2, margins=(0, 0, 0, 0))
        grid.setAlignment(self.combo, Qt.AlignmentFlag.AlignTop)
        grid.setVerticalSpacing(1)
        grid.setColumnStretch(0, 1)

    def show_entry(self, entry: PlanEntry, forced: str | None) -> None:
        """Show what the choice is in the sea, how it is made and what it changes; the reason is in the tooltip."""
        self._subject = entry.subject
        self._choice.setText(_physics().get(entry.subject, entry.subject.replace("_", " ").capitalize()))
        share = _share(entry.error) if entry.error > 0.0 else ""
        duration = f"{format_duration(entry.cost)} a ping" if entry.cost > 0.0 else ""
        if entry.modelled:
            error, cost = share and f"error {share}", duration
        else:
            error, cost = share and f"would change the record by {share}", duration and f"would take {duration}"
        what = entry.choice if entry.options else entry.reason  # without a choice, the reason says more
        self._numbers.setText(" · ".join(filter(None, (what, error, cost))))
        self.setToolTip(literal(f"{entry.reason} (plan.{entry.subject})"))
        options = [*entry.options, *([forced] if forced and forced not in entry.options else [])]
        self.combo.clear()
        self.combo.addItem(AUTOMATIC, None)
        for option in options:
            self.combo.addItem(option, option)
        self.combo.setCurrentIndex(0 if forced is None else self.combo.findData(forced))
        self.combo.setVisible(bool(options))
        self.combo.setAccessibleName(entry.subject)
        self.combo.setToolTip(f"Choose it yourself, or let the program choose (plan.{entry.subject})")

    def light(self, lit: bool) -> None:
        """Light the choice, or let it be as usual."""
        light(self._choice, lit)

    def say(self, words: str) -> None:
        """Show the effect of the forced choice."""
        self._change.setText(words)
        self._change.setVisible(bool(words))


@cache
def _physics() -> dict[str, str]:
    """Read what subjects of the plan are in the sea, by their names."""
    return tomllib.loads((resources() / "window" / "plan.toml").read_text(encoding="utf-8"))


def _number(percent: float) -> NumberField:
    tooltip = "Largest error of the record that you accept, at ranges beyond 1.4 altitudes; more is faster"
    return NumberField("tolerance", "tolerance", tooltip, "%", 0, percent, TOLERANCES, log=True, integer=False)


def _names(entries: list[PlanEntry]) -> list[str]:
    """Names of the lines: the subjects, numbered if they repeat."""
    names: list[str] = []
    for entry in entries:
        names.append(entry.subject if entry.subject not in names else f"{entry.subject} {len(names)}")
    return names


def _share(error: float) -> str:
    return f"{100.0 * error:.2g} %" if error < 0.995 else f"{100.0 * error:.0f} %"
