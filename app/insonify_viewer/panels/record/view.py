"""Display options of records, contrast, measuring and contacts, in folding sections."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QAction, QIcon, QKeyEvent, QPixmap
from PySide6.QtWidgets import (
    QCheckBox,
    QDoubleSpinBox,
    QGridLayout,
    QLineEdit,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from insonify.arrays import Floats, Reals
from insonify.display.display_options import PALETTES, SCALES, SIDES, DisplayOptions
from insonify.io.contacts import CONFIDENCES, Contact
from insonify_viewer.record.tone_map import ToneMap
from insonify_viewer.state.fields import ChoiceField, NumberField
from insonify_viewer.widgets.buttons import make, make_action, make_label, push_button, tick_box
from insonify_viewer.widgets.field_rows import ChoiceRow, Combo, NumberRow
from insonify_viewer.widgets.layouts import fill, fill_grid
from insonify_viewer.widgets.plot import Canvas, Plot
from insonify_viewer.widgets.side_panel import FoldingBox, SidePanel
from insonify_viewer.widgets.text import literal
from insonify_viewer.widgets.theme import QUIET, TEXT

REACH = 30.0  # dB either way
TICKS = (  # option, label, key, what it does
    ("ground_range", "Ground range", "G", "Distance along a level bed instead of slant range"),
    ("water_column", "Water column", "Shift+W", "Show the water between sonar and bed"),
    ("bottom_line", "Bottom line", "B", "Line at the slant range of the bed beneath the sonar"),
    ("range_lines", "Range lines", "L", "Lines of equal range"),
    ("newest_on_top", "Newest on top", "N", "Newest pings at the top instead of at the bottom"),
    ("decibels", "Decibels", "Shift+D", "Colours follow the level in decibels instead of the amplitude"),
    ("reverse", "Reversed colours", "I", "Strong echoes dark, shadows bright"),
    ("draped", "Draped in 3-D", "Shift+B", "Lay the record over the bed of the 3-D view"),
)
CHOICES = (
    ("side", "sides", SIDES, "Sides that are shown (keys 1, 2 and 3)"),
    ("scale", "scale", SCALES, "fill: all of the record; true: a part, a metre as long along as across the track (T)"),
    ("palette", "palette", PALETTES, "Colours of the record"),
)
GAINS = (  # option, place in it, label, what it does
    ("gain", None, "gain", "Gain of both sides"),
    ("side_gains", 0, "port", "Gain of port alone"),
    ("side_gains", 1, "starboard", "Gain of starboard alone"),
    ("side_slopes", 0, "port slope", "Gain that rises with range, port: dB per tenfold range"),
    ("side_slopes", 1, "starb. slope", "Gain that rises with range, starboard: dB per tenfold range"),
)
MEASURE = "Drag over the record, or press Return at both ends, to measure"
KEYS = (("1", "both"), ("2", "port"), ("3", "starboard"))
ICON = 44  # px
# Of the table of contacts: heading and field, the first the number in the order of marking.
COLUMNS = (
    *(("#", ""), ("name", "name"), ("class", "classification"), ("length", "length"), ("width", "width")),
    *(("height", "height"), ("confidence", "confidence"), ("side", "side"), ("range", "slant_range")),
    *(("ping", "ping"), ("remark", "note")),
)
CLASSES = ("wreck", "aircraft", "pipe", "cable", "container", "anchor", "rock", "mine-like", "debris", "fish", "scour")
SIZES = {
    "length": "Use the length of the last measured line",
    "width": "Use the length of the last measured line as the width",
    "height": "Use the height that follows from the shadow along the last measured line",
}
LARGEST = 10_000.0  # m
HINT = "Point at the record and press C, or click a pixel, then Mark."
LOWEST, HIGHEST = -40.0, 40.0  # dB re level bed
SCALE = (-40.0, "−40"), (-20.0, "−20"), (0.0, "bed"), (20.0, "+20"), (40.0, "+40 dB")
BINS, COLOURS = 160, 320  # of the histogram and of the bar below it
BAR = -0.25  # lower edge of the bar, where the highest count is 1
APART = 0.5  # dB, least distance of the ends
KEY_STEP = 0.5  # dB


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
        tip = "Reset all display options, gains and contrast too"
        self.usual = push_button("Usual display", tip, self._show_usual, wide=True)
        self.histogram = HistogramView()
        tip = (
            "Lay the estimated error of each bin over the record: clear where there is none, in full colour from three"
        )
        self.errors = tick_box("Estimated error", f"{tip} times the tolerance (Shift+E)")
        self._key("Estimated error", "Shift+E", self.errors.toggle)
        self.measure = tick_box("Measure a line", f"{MEASURE} (M)")
        self.measure.toggled.connect(self.measuring)
        self._key("Measure a line", "M", self.measure.toggle)
        self.measured = make_label("about")
        self.measured.setMinimumHeight(5 * self.fontMetrics().lineSpacing())  # of the longest words, wrapped
        self.measured.setAlignment(Qt.AlignmentFlag.AlignTop)
        self.contacts = ContactListView()
        self._lay_out()
        self._add_keys()
        self.show_display(self._look)
        self.show_measured("")

    def show_display(self, look: DisplayOptions) -> None:
        """Show display options; those without effect are disabled."""
        self._look = look
        for name, tick in self.ticks.items():
            with QSignalBlocker(tick):
                tick.setChecked(bool(getattr(look, name)))
        self.ticks["water_column"].setEnabled(not look.ground_range)
        for name, row in self.choices.items():
            row.show_value(_choice(name, look))
        for number, gain in enumerate(self.gains):
            gain.show_value(_gain(number, look))

    def show_measured(self, words: str) -> None:
        """Show what was measured last, or how to measure."""
        self.measured.setText(words or "Drag over the record: a distance and, over a shadow, the height of its target.")

    def _show_usual(self) -> None:
        """Put every display option back, the contrast to that of the record."""
        self.changed.emit(DisplayOptions()._asdict())

    def _settle(self, path: str, value: Any) -> None:
        """Signal an option that a row changes; a released slider has none, and a typed number may be invalid."""
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
        fill(QVBoxLayout(measuring), self.measure, self.measured, margins=(6, 6, 2, 6))
        parts = {"Shown": shown, "Contrast": self.histogram, "Gain": self._gain_rows(), "Measure": measuring}
        parts["Contacts"] = self.contacts
        fill(self.column, *(FoldingBox(title, part, unfolded=True) for title, part in parts.items()), None)

    def _lay_shown(self, grid: QGridLayout) -> None:
        grid.setContentsMargins(6, 6, 2, 6)
        grid.setHorizontalSpacing(10)
        for number, (name, label, key, about) in enumerate(TICKS):
            self.ticks[name] = tick_box(label, f"{about} ({key})")
            self.ticks[name].toggled.connect(lambda on, name=name: self.changed.emit({name: on}))
            grid.addWidget(self.ticks[name], number // 2, number % 2)
        rows = QWidget()
        fill_grid(QGridLayout(rows), [row.parts for row in self.choices.values()], 3, margins=(0, 4, 0, 0))
        grid.addWidget(self.errors, len(TICKS), 0)
        grid.addWidget(rows, len(TICKS) + 1, 0, 1, 2)
        grid.addWidget(self.usual, len(TICKS) + 2, 0, 1, 2)

    def _gain_rows(self) -> QWidget:
        rows = QWidget()
        fill_grid(QGridLayout(rows), [row.parts for row in self.gains], 3, margins=(6, 6, 2, 6))
        return rows

    def _add_keys(self) -> None:
        """Make an action for every key; the window holds them, so that they work while the panel is hidden."""
        for name, label, key, _ in TICKS:
            self._key(label, key, lambda name=name: self.changed.emit({name: not getattr(self._look, name)}))
        for key, side in KEYS:
            self._key(f"Show {side}", key, lambda side=side: self.changed.emit({"side": side}))
        other = dict(zip(SCALES, reversed(SCALES)))
        self._key("True scale", "T", lambda: self.changed.emit({"scale": other[self._look.scale]}))
        self._key("Zoom in", "+", lambda: self.zoomed.emit(1.5))
        self._key("Zoom out", "-", lambda: self.zoomed.emit(1.0 / 1.5))
        self._key("Whole record", "0", lambda: self.zoomed.emit(0.0))
        self._key("Mark a contact", "C", self.contact_wanted.emit)
        self._key("Usual display", "", self._show_usual)

    def _key(self, text: str, key: str, act: Any) -> None:
        self.keys.append(make_action(self, text, text, key, act))


def _choice(name: str, look: DisplayOptions) -> ChoiceField:
    _, label, options, about = next(row for row in CHOICES if row[0] == name)
    return ChoiceField(name, label, about, 0, getattr(look, name), options)


def _gain(row: int, look: DisplayOptions) -> NumberField:
    name, place, label, about = GAINS[row]
    value = getattr(look, name) if place is None else getattr(look, name)[place]
    path = name if place is None else f"{name}.{place}"
    return NumberField(path, label, about, "dB", 0, value, (-REACH, REACH), log=False, integer=False, name=about)


class ContactListView(QWidget):
    """Lists contacts in a table that sorts by its columns, and signals what the person does to the chosen one."""

    remove_wanted = Signal(int)
    jump_wanted = Signal(int)
    chosen = Signal(int)  # -1 for none
    edited = Signal(int, str, object)  # which, name of the field, value
    size_wanted = Signal(int, str)  # which, and the field that takes over what was measured last

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.list = _make_table()
        self.list.currentCellChanged.connect(lambda *_: self._choose())
        self.list.itemActivated.connect(lambda _: self.jump_wanted.emit(self.row))
        self.name, self.note = _line("Name of the contact"), _line("Remark on the contact")
        self.classification, self.confidence = Combo("Class of the contact"), Combo("How sure its class is")
        self.classification.setEditable(True)
        self.classification.addItems(("", *CLASSES))
        self.confidence.addItems(CONFIDENCES)
        written = self.classification.lineEdit()
        assert written is not None  # the combo box is editable
        for field, line in (("name", self.name), ("note", self.note), ("classification", written)):
            line.editingFinished.connect(lambda field=field, line=line: self._edit(field, line.text()))
        for field, combo in (("classification", self.classification), ("confidence", self.confidence)):
            combo.textActivated.connect(lambda text, field=field: self._edit(field, text))
        self.sizes = {field: _size(field) for field in SIZES}
        self.takes = {field: push_button("Take", tip, style="small") for field, tip in SIZES.items()}
        for field in SIZES:
            self.sizes[field].valueChanged.connect(lambda size, field=field: self._edit(field, size or None))
            self.takes[field].clicked.connect(lambda _=False, field=field: self.size_wanted.emit(self.row, field))
            self.takes[field].setAccessibleName(SIZES[field])
        self.mark = push_button("Mark", "Mark a contact at the clicked pixel; C marks one under the mouse")
        self.jump = push_button("Show", "Show the contact in its record", lambda: self.jump_wanted.emit(self.row))
        tip = "Remove the contact from the list"
        self.remove = push_button("Remove", tip, lambda: self.remove_wanted.emit(self.row))
        self.open = push_button("Open…", "Open a file of contacts, which replaces this list")
        self.save = push_button("Save…", "Save the contacts as GeoJSON with their pictures, or as a CSV table")
        self.report = push_button("Report…", "Write a report with pictures as PDF or HTML, or placemarks as KML")
        self.hint = make_label("about", HINT)
        self._contacts: Sequence[Contact] = ()
        self._lay()
        self.show_contacts(())

    @property
    def row(self) -> int:
        """Place of the chosen contact in the order of marking; -1 for none."""
        item = self.list.item(self.list.currentRow(), 0)
        return -1 if item is None else int(item.data(Qt.ItemDataRole.DisplayRole)) - 1

    def choose(self, row: int) -> None:
        """Choose a contact by its place in the order of marking, however the table is sorted."""
        found = self.list.findItems(str(row + 1), Qt.MatchFlag.MatchExactly)
        self.list.setCurrentCell(next((item.row() for item in found if item.column() == 0), -1), 1)

    def show_contacts(self, contacts: Sequence[Contact]) -> None:
        """List contacts; the chosen one stays chosen, or the first new one if there are more than before."""
        row, header = self.row, self.list.horizontalHeader()
        if len(contacts) > len(self._contacts):
            shared = zip(contacts, self._contacts, strict=False)
            row = next((number for number, (new, old) in enumerate(shared) if new is not old), len(self._contacts))
        with QSignalBlocker(self.list):
            sorting = header.sortIndicatorSection(), header.sortIndicatorOrder()
            self.list.setSortingEnabled(False)
            self.list.sortItems(0)
            self.list.setRowCount(len(contacts))
            for number, contact in enumerate(contacts):
                # An entry holds a picture: those that stay are not made again at every change of the scene.
                if number >= len(self._contacts) or contact is not self._contacts[number]:
                    for column, item in enumerate(_items(number, contact)):
                        self.list.setItem(number, column, item)
            self._contacts = tuple(contacts)
            self.list.setSortingEnabled(True)
            self.list.sortItems(*sorting)
            self.list.resizeColumnsToContents()
            self.choose(min(row, len(contacts) - 1))
        self.hint.setVisible(not contacts)
        for widget in (self.list, self.form):
            widget.setVisible(bool(contacts))
        for button in (self.save, self.report):
            button.setEnabled(bool(contacts))
        self._choose()

    def _choose(self) -> None:
        """Show the fields of the chosen contact."""
        row = self.row
        contact = self._contacts[row] if 0 <= row < len(self._contacts) else None
        for widget in (self.form, self.jump, self.remove):
            widget.setEnabled(contact is not None)
        self.name.setText(contact.name if contact else "")
        self.note.setText(contact.note if contact else "")
        self.classification.setCurrentText(contact.classification if contact else "")
        self.confidence.setCurrentText(contact.confidence if contact else "")
        for field, size in self.sizes.items():
            with QSignalBlocker(size):
                size.setValue((getattr(contact, field) if contact else None) or 0.0)
        self.chosen.emit(row)

    def _edit(self, field: str, value: object) -> None:
        row = self.row
        if 0 <= row < len(self._contacts) and value != getattr(self._contacts[row], field):
            self.edited.emit(row, field, value)

    def _lay(self) -> None:
        self.form = QWidget()
        named: dict[str, QWidget] = {"name": self.name, "class": self.classification, "confidence": self.confidence}
        rows: list[tuple[QWidget, ...]] = []
        for text, field in (named | self.sizes | {"remark": self.note}).items():
            label = make_label("name", text)
            label.setBuddy(field)
            rows.append((label, field, self.takes[text]) if text in self.takes else (label, field))
        form = fill_grid(QGridLayout(self.form), rows, 3, margins=(0, 0, 0, 0))
        buttons = (self.mark, self.jump, self.remove), (self.open, self.save, self.report)
        tools = fill_grid(QGridLayout(), buttons, 3)
        for layout in (form, tools):
            layout.setSpacing(5)
        fill(QVBoxLayout(self), self.hint, self.list, self.form, tools, margins=(6, 6, 2, 6), spacing=5)


def _make_table() -> QTableWidget:
    table = make(QTableWidget, 0, len(COLUMNS), objectName="contacts", accessibleName="Contacts", showGrid=False)
    table.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
    table.setSelectionBehavior(QTableWidget.SelectionBehavior.SelectRows)
    table.setSelectionMode(QTableWidget.SelectionMode.SingleSelection)
    table.setTabKeyNavigation(False)
    table.setHorizontalHeaderLabels([title for title, _ in COLUMNS])
    table.setIconSize(QSize(ICON, ICON))
    table.setMinimumHeight(4 * ICON)
    table.setToolTip("A double click, or Enter, shows the contact in its record; a click on a heading sorts")
    table.verticalHeader().hide()
    table.verticalHeader().setDefaultSectionSize(ICON)
    table.sortItems(0)
    return table


def _items(number: int, contact: Contact) -> list[QTableWidgetItem]:
    """Cells of a contact; numbers sort as numbers, and its picture stands beside its name."""
    where = "" if contact.x is None or contact.y is None else f"x {contact.x:.2f} m, y {contact.y:.2f} m; "
    items = []
    for title, field in COLUMNS:
        value = getattr(contact, field) if field else number + 1
        item = QTableWidgetItem()
        item.setData(Qt.ItemDataRole.DisplayRole, round(value, 2) if isinstance(value, float) else value)
        item.setToolTip(literal(f"{contact.name}: {where}{contact.source}"))
        picture = QPixmap()
        if title == "name" and contact.snapshot and picture.loadFromData(contact.snapshot):
            item.setIcon(QIcon(picture))
        items.append(item)
    return items


def _size(field: str) -> QDoubleSpinBox:
    size = make(QDoubleSpinBox, maximum=LARGEST, suffix=" m", specialValueText="–", keyboardTracking=False)
    size.setToolTip(f"{field.capitalize()} in metres; – where it was not measured")
    size.setAccessibleName(f"{field} of the contact")
    return size


def _line(name: str) -> QLineEdit:
    line = make(QLineEdit, objectName="line", accessibleName=name, toolTip=name)
    line.returnPressed.connect(line.clearFocus)
    return line


class HistogramView(Plot):
    """Shows how often each level occurs, and the colours of the levels."""

    ends_dragged = Signal(float, float)  # ends in dB re level bed; minus infinity for silence

    def __init__(self) -> None:
        tip = (
            "How often each level occurs in the record. Drag the ends of the colour bar to set the contrast. Keys: "
            "← → upper end, Shift+← → lower end."
        )
        name, focus = "Contrast: levels of the record over the colour bar", Qt.FocusPolicy.TabFocus
        super().__init__(name, tip, still=True, grid=False, minimumHeight=104, focusPolicy=focus)
        self.counts: Floats = np.zeros(BINS)
        self._find: Callable[[], Reals] | None = None  # gives the levels to count
        self._colours = np.zeros((1, COLOURS, 3), np.uint8)
        self.ends = (LOWEST, HIGHEST)
        self.dragged.connect(lambda number, level, _: self._move(number, level if level > LOWEST else -np.inf))

    def show_levels(self, find: Callable[[], Reals]) -> None:
        """Count levels in dB re level bed when they are next drawn: behind a tab, never."""
        self._find = find
        self.redraw()

    def show_colours(self, tone_map: ToneMap) -> None:
        """Show the colours of levels, and the ends of the palette."""
        with np.errstate(divide="ignore"):
            ends = tone_map.ends if tone_map.decibels else 20.0 * np.log10(np.maximum(tone_map.ends, 0.0))
        self.ends = float(ends[0]), float(ends[1])
        self.marks = [(min(max(end, LOWEST), HIGHEST), 0.5 * BAR) for end in self.ends]  # over the colour bar
        levels = np.linspace(LOWEST, HIGHEST, COLOURS, dtype=np.float32)
        words = tone_map.colours(10.0 ** (levels / np.float32(20.0)))[None, :, None]
        self._colours = (words >> np.array([16, 8, 0], np.uint32) & 0xFF).astype(np.uint8)
        self.redraw()

    def draw(self, canvas: Canvas) -> None:
        """Draw histogram, colour bar and its ends."""
        find, self._find = self._find, None
        if find is not None:
            counts, _ = np.histogram(find(), bins=BINS, range=(LOWEST, HIGHEST))
            self.counts = np.sqrt(counts / max(int(counts.max()), 1))  # so that rare levels are seen
        canvas.hideAxis("left")
        canvas.number("bottom", SCALE)
        canvas.area(np.linspace(LOWEST, HIGHEST, BINS), self.counts, 0.0, QUIET)
        canvas.picture(self._colours, (LOWEST, HIGHEST), (BAR, 0.0))
        for end, _ in self.marks:
            canvas.rule(end, TEXT, style=Qt.PenStyle.SolidLine)
        self.limit((LOWEST - 4.0, HIGHEST + 8.0), (BAR, 1.05))

    def distance(self, mark: tuple[float, float], place: QPointF) -> float:
        """Distance from a line through an end, px."""
        return abs(self.place_of(*mark).x() - place.x())

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move an end by half a decibel."""
        turn = {Qt.Key.Key_Left: -KEY_STEP, Qt.Key.Key_Right: KEY_STEP}.get(Qt.Key(event.key()))
        if turn is None:
            super().keyPressEvent(event)
            return
        number = 0 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        self._move(number, max(self.ends[number], LOWEST) + turn)

    def _move(self, number: int, level: float) -> None:
        low, high = self.ends
        level = min(level, HIGHEST)
        low, high = (min(level, high - APART), high) if number == 0 else (low, max(level, low + APART, LOWEST + APART))
        if (low, high) != self.ends:
            self.ends_dragged.emit(low, high)
