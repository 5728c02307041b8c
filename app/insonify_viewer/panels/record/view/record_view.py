"""Display options of records, contrast, measuring and contacts, in folding sections."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import QCheckBox, QGridLayout, QLabel, QVBoxLayout, QWidget

from insonify.display.display_options import PALETTES, SCALES, SIDES, DisplayOptions
from insonify_viewer.panels.record.view.contact_list import ContactListView
from insonify_viewer.panels.record.view.histogram_view import HistogramView
from insonify_viewer.state.fields import ChoiceField, NumberField
from insonify_viewer.widgets.field_rows import ChoiceRow, NumberRow
from insonify_viewer.widgets.folding_box import FoldingBox
from insonify_viewer.widgets.push_button import push_button
from insonify_viewer.widgets.side_panel import SidePanel

REACH = 30.0  # dB either way
TICKS = (  # option, label, key, what it does
    ("ground_range", "Ground range", "G", "Ground range of a level bed in place of slant range"),
    ("water_column", "Water column", "Shift+W", "Begin slant range at the sonar; else at the first echo of the bed"),
    ("bottom_line", "Bottom line", "B", "The slant range of the bed beneath the sonar"),
    ("range_lines", "Range lines", "L", "Lines of equal range"),
    ("newest_on_top", "Newest on top", "N", "Later pings above earlier ones; else below"),
    ("decibels", "Decibels", "Shift+D", "Colours linear in decibels; else in amplitude"),
    ("reverse", "Reversed colours", "I", "From bright to dark"),
    (
        "draped",
        "Draped in 3-D",
        "Shift+B",
        "The record over the bed of the 3-D view, by ground range",
    ),
)
CHOICES = (
    ("side", "sides", SIDES, "Sides that are shown (keys 1, 2 and 3)"),
    ("scale", "scale", SCALES, "True scale where it fills most of the room, true scale always, or all of the room (T)"),
    ("palette", "palette", PALETTES, "Colours of the record"),
)
GAINS = (  # option, place in it, label, what it does
    ("gain", None, "gain", "Gain of both sides"),
    ("side_gains", 0, "port", "Gain of port alone"),
    ("side_gains", 1, "starboard", "Gain of starboard alone"),
    ("side_slopes", 0, "port slope", "Time-varied gain of port per decade of range, 0 dB at half the range"),
    ("side_slopes", 1, "starb. slope", "Time-varied gain of starboard per decade of range, 0 dB at half the range"),
)
MEASURE = "Drag over the record, or press Return at both ends, to measure"
KEYS = (("1", "both"), ("2", "port"), ("3", "starboard"))


class RecordView(SidePanel):
    """Shows the display options, and signals their changes."""

    changed = Signal(dict)  # display options by name
    measuring = Signal(bool)
    zoomed = Signal(float)  # factor; 0 for the whole record
    contact_wanted = Signal()  # under the mouse

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._look = DisplayOptions()
        self.keys: list[QAction] = []
        self.ticks: dict[str, QCheckBox] = {}
        self.choices = {name: ChoiceRow(_choice(name, self._look), self._settle) for name, *_ in CHOICES}
        self.gains = [NumberRow(_gain(row, self._look), self._settle, self._settle) for row in range(len(GAINS))]
        self.usual = push_button("Usual display", "Put all display options back, gains and contrast too", wide=True)
        self.usual.clicked.connect(self._show_usual)
        self.histogram = HistogramView()
        self.measure = self._tick("Measure a line", "M", MEASURE, self.measuring)
        self.measured = QLabel()
        self.measured.setObjectName("about")
        self.measured.setWordWrap(True)
        self.measured.setMinimumHeight(5 * self.fontMetrics().lineSpacing())  # of the longest words, wrapped
        self.measured.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.measured.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.contacts = ContactListView()
        self._lay_out()
        self._add_keys()
        self.show_display(self._look)
        self.show_measured("")

    def show_display(self, look: DisplayOptions) -> None:
        """Show display options; those without effect stand aside."""
        self._look = look
        for name, tick in self.ticks.items():
            tick.blockSignals(True)
            tick.setChecked(bool(getattr(look, name)))
            tick.blockSignals(False)
        self.ticks["water_column"].setEnabled(not look.ground_range)
        for name, row in self.choices.items():
            row.show_value(_choice(name, look))
        for number, gain in enumerate(self.gains):
            gain.show_value(_gain(number, look))

    def show_measured(self, words: str) -> None:
        """Show what was measured last, or how to measure."""
        self.measured.setText(words or "Drag over the record: distance, and the height of a target from its shadow.")

    def _show_usual(self) -> None:
        """Put every display option back, the contrast to that of the record."""
        self.changed.emit(DisplayOptions()._asdict())

    def _settle(self, path: str, value: Any) -> None:
        """Signal an option that a row changes; a slider that is let go has none, a number may be no number."""
        if not path:
            return
        name, _, place = path.partition(".")
        if place or name == "gain":
            try:
                number = float(value)
            except ValueError:
                self.show_display(self._look)
                return
            pair = list(getattr(self._look, name)) if place else []
            if place:
                pair[int(place)] = number
            value = tuple(pair) if place else number
        self.changed.emit({name: value})

    def _lay_out(self) -> None:
        shown, measuring = QWidget(), QWidget()
        self._lay_shown(QGridLayout(shown))
        lines = QVBoxLayout(measuring)
        lines.setContentsMargins(6, 6, 2, 6)
        lines.addWidget(self.measure)
        lines.addWidget(self.measured)
        for title, part in (
            ("Shown", shown),
            ("Contrast", self.histogram),
            ("Gain", self._gain_rows()),
            ("Measure", measuring),
            ("Contacts", self.contacts),
        ):
            self.column.addWidget(FoldingBox(title, part, unfolded=True))
        self.column.addStretch(1)

    def _lay_shown(self, grid: QGridLayout) -> None:
        grid.setContentsMargins(6, 6, 2, 6)
        grid.setHorizontalSpacing(10)
        for number, (name, label, key, about) in enumerate(TICKS):
            tick = QCheckBox(label)
            tick.setToolTip(f"{about} ({key})")
            tick.setFocusPolicy(Qt.FocusPolicy.TabFocus)
            tick.toggled.connect(lambda on, name=name: self.changed.emit({name: on}))
            self.ticks[name] = tick
            grid.addWidget(tick, number // 2, number % 2)
        rows = QWidget()
        inner = QGridLayout(rows)
        inner.setContentsMargins(0, 4, 0, 0)
        for number, row in enumerate(self.choices.values()):
            row.place(inner, number)
        grid.addWidget(rows, len(TICKS), 0, 1, 2)
        grid.addWidget(self.usual, len(TICKS) + 1, 0, 1, 2)

    def _gain_rows(self) -> QWidget:
        rows = QWidget()
        grid = QGridLayout(rows)
        grid.setContentsMargins(6, 6, 2, 6)
        for number, row in enumerate(self.gains):
            row.place(grid, number)
        return rows

    def _tick(self, text: str, key: str, about: str, signal: Any) -> QCheckBox:
        tick = QCheckBox(text)
        tick.setToolTip(f"{about} ({key})")
        tick.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        tick.toggled.connect(signal)
        self._key(text, key, tick.toggle)
        return tick

    def _add_keys(self) -> None:
        """Make an action for every key; the window holds them, so that they work while the panel is hidden."""
        for name, label, key, _ in TICKS:
            self._key(label, key, lambda name=name: self.changed.emit({name: not getattr(self._look, name)}))
        for key, side in KEYS:
            self._key(f"Show {side}", key, lambda side=side: self.changed.emit({"side": side}))
        self._key("True scale", "T", lambda: self.changed.emit({"scale": _other_scale(self._look)}))
        self._key("Zoom in", "+", lambda: self.zoomed.emit(1.5))
        self._key("Zoom out", "-", lambda: self.zoomed.emit(1.0 / 1.5))
        self._key("Whole record", "0", lambda: self.zoomed.emit(0.0))
        self._key("Mark a contact", "C", self.contact_wanted.emit)
        self._key("Usual display", "", self._show_usual)

    def _key(self, text: str, key: str, act: Any) -> None:
        action = QAction(text, self)
        action.setShortcut(QKeySequence(key))
        action.triggered.connect(lambda: act())
        self.keys.append(action)


def _other_scale(look: DisplayOptions) -> str:
    return "fit" if look.scale == "true" else "true"


def _choice(name: str, look: DisplayOptions) -> ChoiceField:
    _, label, options, about = next(row for row in CHOICES if row[0] == name)
    return ChoiceField(name, label, about, 0, getattr(look, name), options)


def _gain(row: int, look: DisplayOptions) -> NumberField:
    name, place, label, about = GAINS[row]
    value = getattr(look, name) if place is None else getattr(look, name)[place]
    path = name if place is None else f"{name}.{place}"
    return NumberField(path, label, about, "dB", 0, value, (-REACH, REACH), log=False, integer=False, name=about)
