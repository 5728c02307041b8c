"""Question about a data set: by which specification, how many scenes, and where."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from PySide6.QtWidgets import (
    QComboBox,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QFormLayout,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QSpinBox,
    QWidget,
)

MOST_SCENES, USUAL_SCENES = 1_000_000, 20


class WantedDataset(NamedTuple):
    """A data set to be made."""

    specification: str  # name of a bundled specification, or a file
    scenes: int
    folder: Path


class DatasetQuestion(QDialog):
    """Asks for a data set."""

    def __init__(self, bundled: list[str], parent: QWidget) -> None:
        super().__init__(parent)
        self.setWindowTitle("Make a data set")
        self.specification = QComboBox()
        self.specification.setEditable(True)
        self.specification.addItems(bundled)
        self.specification.setToolTip("A bundled specification, or the path of a TOML file")
        self.scenes = QSpinBox()
        self.scenes.setRange(1, MOST_SCENES)
        self.scenes.setValue(USUAL_SCENES)
        self.scenes.setToolTip(f"Number of scenes that are drawn at random, 1 to {MOST_SCENES}")
        self.folder = QLineEdit(str(Path.home() / (bundled[0] if bundled else "dataset")))
        self.folder.setObjectName("line")
        self.folder.setToolTip("Folder to make, or one in which a stopped data set goes on")
        for name, field in (("Specification", self.specification), ("Scenes", self.scenes), ("Folder", self.folder)):
            field.setAccessibleName(name)
        self.buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel)
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        form = QFormLayout(self)
        form.addRow("Specification", _beside(self.specification, "File…", "Pick a TOML file", self._choose_file))
        form.addRow("Scenes", self.scenes)
        form.addRow("Folder", _beside(self.folder, "Choose…", "Pick the folder of the data set", self._choose_folder))
        form.addRow(self.buttons)

    @property
    def answer(self) -> WantedDataset:
        """What was asked for."""
        return WantedDataset(self.specification.currentText(), self.scenes.value(), Path(self.folder.text()))

    def _choose_file(self) -> None:
        file, _ = QFileDialog.getOpenFileName(self, "Open a specification", "", "Specifications (*.toml)")
        if file:
            self.specification.setCurrentText(file)

    def _choose_folder(self) -> None:
        folder = QFileDialog.getExistingDirectory(self, "Folder of the data set", self.folder.text())
        if folder:
            self.folder.setText(folder)


def _beside(field: QWidget, text: str, tip: str, choose: Callable[[], None]) -> QWidget:
    """Put a field and its button side by side."""
    line = QWidget()
    row = QHBoxLayout(line)
    row.setContentsMargins(0, 0, 0, 0)
    button = QPushButton(text)
    button.setToolTip(tip)
    button.clicked.connect(choose)
    row.addWidget(field, 1)
    row.addWidget(button)
    return line
