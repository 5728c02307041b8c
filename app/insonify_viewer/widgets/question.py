"""Dialog of named fields, one below the other, with OK and Cancel."""

from collections.abc import Callable

from PySide6.QtWidgets import QDialog, QDialogButtonBox, QFormLayout, QHBoxLayout, QPushButton, QWidget

from insonify_viewer.widgets.buttons import make
from insonify_viewer.widgets.layouts import fill


class Question(QDialog):
    """Asks for the values of some fields."""

    def __init__(self, title: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle(title)
        self.form = QFormLayout(self)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)

    def add(self, name: str, field: QWidget, tip: str, choose: Callable[[], None] | None = None) -> None:
        """Add a row, with a button where a file can be chosen."""
        field.setAccessibleName(name)
        field.setToolTip(tip)
        if choose is not None:
            line = QWidget()
            button = make(QPushButton, "Choose…", toolTip=tip)
            button.clicked.connect(choose)
            fill(QHBoxLayout(line), field, button, growing=field, margins=(0, 0, 0, 0))
        self.form.addRow(name, field if choose is None else line)

    def end(self) -> None:
        """Add the buttons below all rows."""
        self.form.addRow(self.buttons)
