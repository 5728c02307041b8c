"""Sections of sliders, combo boxes and files, one for each part of the scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtWidgets import (
    QFrame,
    QGridLayout,
    QLabel,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from insonify.scene import Scene
from insonify_viewer.fields import ChoiceField, NumberField, Parameter
from insonify_viewer.panels.parameters.sections import FieldSection
from insonify_viewer.views.field_rows import ChoiceRow, FileRow, NumberRow
from insonify_viewer.views.folding_box import FoldingBox
from insonify_viewer.views.lighting import light
from insonify_viewer.views.setting_pictures.base import SettingPicture
from insonify_viewer.views.setting_pictures.registry import pictures_of_settings

NARROWEST = 316  # px
DELAY = 20  # ms, by which the other numbers follow a slider that moves
OPEN_AT_FIRST = ("sonar", "seabed", "track")
Row = NumberRow | ChoiceRow | FileRow


class ParametersView(QScrollArea):
    """Shows the fields of a scene and signals the edits of the person."""

    dragged = Signal(str, object)
    settled = Signal(str, object)
    file_asked = Signal(str)
    removed = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setMinimumWidth(NARROWEST)
        self._body = QWidget()
        self._body.setObjectName("panel")
        self._column = QVBoxLayout(self._body)
        self._column.setContentsMargins(8, 8, 8, 8)
        self._column.setSpacing(6)
        self._about = AboutBox()
        self._column.addWidget(self._about)
        self._column.addStretch(1)
        self.setWidget(self._body)
        self._sections: dict[str, SectionBox] = {}
        self._lit: tuple[str, ...] = ()
        self._show: Callable[[], None] = _nothing
        self._due = QTimer(self)
        self._due.setSingleShot(True)
        self._due.setInterval(DELAY)
        self._due.timeout.connect(lambda: self._show())

    @property
    def about(self) -> str:
        """The description that is shown."""
        return self._about.words

    def show_at_once(self, show: Callable[[], None]) -> None:
        """Run an update now, instead of one that waits."""
        self._due.stop()
        show()

    def show_soon(self, show: Callable[[], None]) -> None:
        """Run an update after a short delay; updates within it are merged."""
        self._show = show
        if not self._due.isActive():
            self._due.start()

    def stop_waiting(self) -> None:
        """Drop the update that waits."""
        self._due.stop()

    def show_about(self, description: str) -> None:
        """Show the description of the scene."""
        self._about.say(description)

    def show_sections(self, sections: tuple[FieldSection, ...]) -> None:
        """Show these fields; only sections whose rows change are rebuilt."""
        keys = [section.key for section in sections]
        for key in [key for key in self._sections if key not in keys]:
            self._drop(key)
        for place, section in enumerate(sections):
            box = self._sections.get(section.key)
            if box is not None and box.structure == section.structure:
                box.show_values(section)
                continue
            unfolded = section.key in OPEN_AT_FIRST if box is None else box.unfolded
            if box is not None:
                self._drop(section.key)
            box = SectionBox(section, self, unfolded=unfolded)
            self._sections[section.key] = box
            self._column.insertWidget(place + 1, box)
        self._light_rows()

    def show_pictures(self, scene: Scene) -> None:
        """Show the curves of a scene, and the spectrum of its bed."""
        for box in self._sections.values():
            for picture in box.pictures:
                picture.show_scene(scene)

    def turn_to(self, key: str) -> None:
        """Unfold the section of a target, fold those of the others, and scroll to it."""
        for name, box in self._sections.items():
            if box.removable:
                box.unfold(name == key)
        self._sections[key].show()
        self._lay_out()
        self.ensureWidgetVisible(self._sections[key], 0, 8)

    def light(self, paths: tuple[str, ...]) -> None:
        """Light the rows of these fields and no others; unfold their sections and scroll to the first that is there."""
        self._lit = paths
        self._light_rows()
        boxes = [box for box in self._sections.values() if any(path in box.rows for path in paths)]
        for box in boxes:
            box.unfold(True)
        QTimer.singleShot(0, self, self._scroll_to_lit)  # sections of a scene just opened have no place before

    def _scroll_to_lit(self) -> None:
        """Bring the first row that is lit into view, in the order of the fields."""
        rows = [box.rows[path] for path in self._lit for box in self._sections.values() if path in box.rows]
        if rows:
            self._lay_out()
            self.ensureWidgetVisible(rows[0].label, 0, self.height() // 3)

    def row(self, path: str) -> Row:
        """Find the row of a field by its dotted path."""
        return next(box.rows[path] for box in self._sections.values() if path in box.rows)

    def _lay_out(self) -> None:
        """Lay the sections out now: the scroll bar reaches a new one only after that."""
        self._column.activate()
        self._body.resize(self._body.width(), self._body.sizeHint().height())

    def _light_rows(self) -> None:
        for box in self._sections.values():
            for path, row in box.rows.items():
                light(row.label, path in self._lit)

    def _drop(self, key: str) -> None:
        box = self._sections.pop(key)
        self._column.removeWidget(box)
        box.hide()
        box.deleteLater()


class AboutBox(FoldingBox):
    """The description of the scene, under a heading that folds."""

    def __init__(self) -> None:
        self._words = QLabel()
        self._words.setObjectName("about")
        self._words.setWordWrap(True)
        self._words.setTextFormat(Qt.TextFormat.PlainText)
        self._words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        super().__init__("About this scene", self._words, unfolded=True)

    @property
    def words(self) -> str:
        """The text."""
        return self._words.text()

    def say(self, description: str) -> None:
        """Show a description; without one, hide the heading too."""
        self._words.setText(" ".join(description.split()))
        self.setVisible(bool(description.strip()))


class SectionBox(FoldingBox):
    """The rows of one section, under a heading that folds.

    Attributes
    ----------
    rows : dict of str to row
        By dotted path.
    pictures : list of SettingPicture
        Below the rows of the settings that they show.
    structure, removable : tuple, bool
        Of the section it was built from.
    """

    def __init__(self, section: FieldSection, panel: ParametersView, *, unfolded: bool) -> None:
        self.structure, self.removable = section.structure, section.removable
        self.rows: dict[str, Row] = {}
        body = QWidget()
        grid = QGridLayout(body)
        grid.setContentsMargins(6, 4, 2, 4)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        grid.setColumnStretch(1, 1)
        for line, parameter in enumerate(section.parameters):
            row = _row(parameter, panel)
            row.place(grid, 2 * line)
            self.rows[parameter.path] = row
        self.pictures = _pictures(section, grid, panel)
        remover = _remover(section, panel) if section.removable else None
        super().__init__(section.title, body, unfolded=unfolded, beside=remover)

    def show_values(self, section: FieldSection) -> None:
        """Show other values in the same rows."""
        self.entitle(section.title)
        for parameter in section.parameters:
            row: Any = self.rows[parameter.path]
            row.show_value(parameter)


def _nothing() -> None:
    """Update nothing."""


def _row(parameter: Parameter, panel: ParametersView) -> Row:
    """Make the row of a field."""
    if isinstance(parameter, NumberField):
        return NumberRow(parameter, panel.dragged.emit, panel.settled.emit)
    if isinstance(parameter, ChoiceField):
        return ChoiceRow(parameter, panel.settled.emit)
    return FileRow(parameter, panel.file_asked.emit)


def _pictures(section: FieldSection, grid: QGridLayout, panel: ParametersView) -> list[SettingPicture]:
    """Place the pictures of a section, each below the last row of its setting; rows fill every other line."""
    placed = []
    for path, picture in pictures_of_settings().items():
        lines = [line for line, parameter in enumerate(section.parameters) if parameter.path.startswith(f"{path}.")]
        if lines:
            grid.addWidget(picture, 2 * lines[-1] + 1, 0, 1, 3)
            picture.dragged.connect(panel.dragged)
            picture.settled.connect(panel.settled)
            placed.append(picture)
    return placed


def _remover(section: FieldSection, panel: ParametersView) -> QToolButton:
    """Make the button that removes the target of a section from the scene."""
    button = QToolButton()
    button.setObjectName("remove")
    button.setText("×")
    button.setToolTip("Remove this target")
    button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
    button.setFixedWidth(26)
    button.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
    key = section.key
    button.clicked.connect(lambda: panel.removed.emit(key))
    return button
