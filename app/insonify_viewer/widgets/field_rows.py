"""Rows of widgets for one field each: a slider with a number, a combo box, or a file button."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6.QtCore import Qt
from PySide6.QtGui import QContextMenuEvent, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QComboBox, QLabel, QLineEdit, QMenu, QSizePolicy, QSlider, QWidget

from insonify.scene.edit import parse_quantity
from insonify_viewer.state.fields import ChoiceField, FileField, NumberField
from insonify_viewer.state.quantities import format_quantity, slider_position, slider_value
from insonify_viewer.widgets.buttons import make, push_button, set_property
from insonify_viewer.widgets.text import entry_name, literal

STEPS = 1000
NARROWEST = 44  # px, of a slider
WIDEST = 22  # average widths of a letter, of a line of a name
LONGEST = "123.4 dB/km"  # value for which a field has room
INDENT = 12
Change = Callable[[str, Any], None]


class _Slider(QSlider):
    """A slider that ignores the mouse wheel unless it has the focus, so that the panel scrolls."""

    def __init__(self) -> None:
        super().__init__(Qt.Orientation.Horizontal)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setRange(0, STEPS)
        self.setMinimumWidth(NARROWEST)
        self.setPageStep(STEPS // 20)

    def wheelEvent(self, event: QWheelEvent) -> None:
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()


class Combo(QComboBox):
    """A combo box that is as narrow as it must be, and ignores the mouse wheel, so that the panel scrolls."""

    def __init__(self, name: str = "") -> None:
        super().__init__()
        self.setAccessibleName(name)
        self.setToolTip(name)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(6)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def showPopup(self) -> None:
        """Open the list, wide enough for its longest entry."""
        self.view().setMinimumWidth(self.view().sizeHintForColumn(0) + 12)
        super().showPopup()

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Ignore the wheel."""
        event.ignore()


class NameLabel(QLabel):
    """Name of a field; a double click, or its menu, resets a field that was changed."""

    def __init__(self, text: str, about: str, indent: int) -> None:
        super().__init__()
        self.setObjectName("name")
        self._before = ""
        self.reset: Callable[[], None] = lambda: None
        self.ensurePolished()
        self.setText(text)
        self.setContentsMargins(INDENT * indent, 0, 0, 0)
        widest = WIDEST * self.fontMetrics().averageCharWidth()
        if self.sizeHint().width() > widest:
            self.setWordWrap(True)
            self.setFixedWidth(widest)
        self.explain(about)

    def show_reset(self, before: str, reset: Callable[[], None]) -> None:
        """Mark the field as changed from a value, or with an empty text as unchanged."""
        self.reset = reset
        if before != self._before:
            self._before = before
            set_property(self, "changed", bool(before))
            self.explain(self._about)

    def explain(self, about: str) -> None:
        """Show another tooltip, with what a double click does."""
        self._about = about
        self.setToolTip(literal(f"{about}; was {self._before}, double-click to reset") if self._before else about)

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        """Reset the field."""
        if self._before and event.button() is Qt.MouseButton.LeftButton:
            self.reset()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        """Offer to reset the field."""
        menu = QMenu(self)
        reset = f"Reset to {self._before}" if self._before else "Unchanged since the scene was opened"
        entry = menu.addAction(entry_name(reset))
        entry.setEnabled(bool(self._before))
        entry.triggered.connect(lambda: self.reset())
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.popup(event.globalPos())


class FieldRow:
    """Row of a field: its name, and the widgets of its value."""

    def __init__(self, label: NameLabel, name: str, *widgets: QWidget) -> None:
        self.label, self.parts = label, (label, *widgets)  # the parts stand in a grid of three columns
        for widget in widgets:
            widget.setAccessibleName(name)


class NumberRow(FieldRow):
    """Row of a number: its name, a slider, and a text field."""

    def __init__(self, number: NumberField, dragged: Change, settled: Change) -> None:
        self._number, self._dragged, self._settled = number, dragged, settled
        self._showing = False
        self._about = ""
        self.slider = _Slider()
        if number.slider is None:
            self.slider.hide()
        self.field = make(QLineEdit, objectName="value", alignment=Qt.AlignmentFlag.AlignRight)
        self.field.ensurePolished()
        self.field.setFixedWidth(self.field.fontMetrics().horizontalAdvance(LONGEST) + 6)
        self.slider.valueChanged.connect(self._moved)
        self.slider.sliderReleased.connect(lambda: settled("", None))
        label = NameLabel(number.label, number.about, number.indent)
        super().__init__(label, number.name or number.label, self.slider, self.field)
        self.field.editingFinished.connect(self._typed)
        # The keyboard focus returns to the window, where Space pauses.
        self.field.returnPressed.connect(self.field.clearFocus)
        self.show_value(number)

    def show_value(self, number: NumberField) -> None:
        """Show another value, unless the slider is held."""
        self._number = number
        self._show_idle(number.idle)
        if not self.field.hasFocus() or not self.field.isModified():
            self._shown = format_quantity(number.value, number.unit)
            self.field.setText(self._shown)
            self.field.setCursorPosition(0)
        if number.slider is not None and not self.slider.isSliderDown():
            self._showing = True
            self.slider.setValue(round(STEPS * slider_position(number.value, number.slider, log=number.log)))
            self._showing = False

    def _show_idle(self, idle: str) -> None:
        """Disable the row while its number has no effect, with the reason as tooltip."""
        about = f"{self._number.about}; {idle}" if idle else self._number.about
        if about == self._about:
            return
        self._about = about
        for widget in self.parts:
            widget.setEnabled(not idle)
            widget.setToolTip(about)
        self.label.explain(about)

    def _moved(self, position: int) -> None:
        if self._showing or self._number.slider is None:
            return
        number = self._number
        value = slider_value(position / STEPS, self._number.slider, log=number.log, integer=number.integer)
        # Arrow keys and clicks beside the handle make final edits.
        change = self._dragged if self.slider.isSliderDown() else self._settled
        change(number.path, int(value) if number.integer else value)

    def _typed(self) -> None:
        if not self.field.isModified():
            return
        self.field.setModified(False)
        number = self._number
        value = parse_quantity(self.field.text(), number.unit, like=self._shown)
        if value is None or (number.integer and value != round(value)):
            self._settled(number.path, self.field.text())
        else:
            self._settled(number.path, int(value) if number.integer else value)


class ChoiceRow(FieldRow):
    """Row of a choice: its name and a combo box."""

    def __init__(self, choice: ChoiceField, settled: Change) -> None:
        self._choice, self._settled = choice, settled
        self.combo = Combo()
        label = NameLabel(choice.label, choice.about, choice.indent)
        super().__init__(label, choice.name or choice.label, self.combo)
        for option in choice.options:
            name = ("off", "on")[option] if isinstance(option, bool) else str(option).replace("_", " ")
            self.combo.addItem(name, option)
        for place, meaning in enumerate(choice.meanings):
            self.combo.setItemData(place, meaning, Qt.ItemDataRole.ToolTipRole)
        self.combo.activated.connect(self._picked)
        self.show_value(choice)

    def show_value(self, choice: ChoiceField) -> None:
        """Show another value."""
        self._choice = choice
        self.combo.setCurrentIndex(choice.options.index(choice.value))
        self.combo.setToolTip(choice.about)
        self.label.explain(choice.about)

    def _picked(self, index: int) -> None:
        value = self.combo.itemData(index)
        if value != self._choice.value:
            self._settled(self._choice.path, value)


class FileRow(FieldRow):
    """Row of a file: a button with its name, which asks for another."""

    def __init__(self, file: FileField, asked: Callable[[str], None]) -> None:
        self.button = push_button("", file.tooltip, style="file")
        super().__init__(NameLabel(file.label, file.tooltip, file.indent), file.name or file.label, self.button)
        self.button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)  # a long name is clipped
        self.button.clicked.connect(lambda: asked(file.path))
        self.show_value(file)

    def show_value(self, file: FileField) -> None:
        """Show another name."""
        self.button.setText(f"{entry_name(Path(file.value).name)} …")
        self.button.setToolTip(literal(f"{file.tooltip}: {file.value}"))
