"""The rows of one section of fields, the rare ones folded."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Protocol

from PySide6.QtCore import SignalInstance
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from insonify.scene import Scene
from insonify_viewer.panels.parameters.view.setting_pictures import SettingPicture, pictures_of_settings
from insonify_viewer.state.fields import ChoiceField, NumberField, Parameter
from insonify_viewer.state.sections import PINNED, FieldSection
from insonify_viewer.widgets.buttons import light, make
from insonify_viewer.widgets.field_rows import ChoiceRow, FileRow, NumberRow
from insonify_viewer.widgets.layouts import fill, fill_grid
from insonify_viewer.widgets.side_panel import FoldingBox

Row = NumberRow | ChoiceRow | FileRow
TOOL = 26  # px, width of a button beside a heading


class RowSignals(Protocol):
    """Signals of the view that holds the rows."""

    dragged: SignalInstance
    settled: SignalInstance
    file_asked: SignalInstance
    reset: SignalInstance


class SectionBox(FoldingBox):
    """The rows of one section, under a heading that folds."""

    # The rows are built when they are first asked for or unfolded: a scene may have hundreds of them.

    def __init__(
        self,
        section: FieldSection,
        signals: RowSignals,
        *,
        unfolded: bool,
        more: bool = False,
        tools: list[QToolButton],
    ) -> None:
        self.structure, self.removable = section.structure, section.removable
        self._section, self._signals = section, signals
        self._paths = {each.path: each.rare for each in section.parameters}
        self._rows: dict[str, Row] = {}
        self._pictures: list[SettingPicture] = []
        self._more: QToolButton | None = None
        self._shows_more, self.built = more, False
        self._changed: dict[str, str] = {}
        self._lit: tuple[str, ...] = ()
        self._scene: Scene | None = None
        tip = "Reset this section to the scene as it was opened"
        self.reset = make_tool("reset", "↺", tip, lambda: signals.reset.emit(tuple(self._changed)))
        self.reset.hide()
        super().__init__(section.title, QWidget(), unfolded=unfolded, beside=_side_by_side([self.reset, *tools]))
        self._body.setEnabled(not section.locked)
        self._heading.toggled.connect(lambda on: self.build() if on else None)

    @property
    def rows(self) -> dict[str, Row]:
        """The rows by dotted path."""
        self.build()
        return self._rows

    @property
    def more(self) -> QToolButton | None:
        """Button that shows the rare fields; None if there are none."""
        self.build()
        return self._more

    @property
    def waits(self) -> bool:
        """Whether the rows should be seen and are not built yet."""
        return self.unfolded and not self.built

    def holds(self, path: str) -> bool:
        """Whether a field has a row here."""
        return path in self._paths

    def build(self) -> None:
        """Build the rows, unless that is done."""
        if self.built:
            return
        self.built = True
        usual = [each for each in self._section.parameters if not each.rare]
        grid = self._grid(usual, self._signals)
        self._pictures = [] if self._section.key == PINNED else _pictures(usual, grid, self._signals)
        column = fill(QVBoxLayout(self._body), grid, margins=(6, 4, 2, 4), spacing=4)
        if rare := [each for each in self._section.parameters if each.rare]:
            self._add_more(column, rare, self._signals, self._shows_more)
        self._mark_changed()
        self.light(self._lit)
        if self._scene is not None:
            self.show_pictures(self._scene)

    def show_changed(self, changed: Mapping[str, str]) -> None:
        """Mark the fields that differ from the scene as it was opened, given the texts of those values."""
        self._changed = {path: changed[path] for path in self._paths if path in changed}
        self._mark_changed()
        self.reset.setVisible(bool(self._changed))

    def _mark_changed(self) -> None:
        for path, row in self._rows.items():
            row.label.show_reset(self._changed.get(path, ""), partial(self._signals.reset.emit, (path,)))

    def show_values(self, section: FieldSection) -> None:
        """Show other values in the same rows; rows whose fields are the same objects as before stay as they are."""
        before, self._section = self._section, section
        self.entitle(section.title)
        self._body.setEnabled(not section.locked)
        for known, parameter in zip(before.parameters, section.parameters, strict=True) if self.built else ():
            if parameter is not known:
                row: Any = self._rows[parameter.path]
                row.show_value(parameter)

    def show_pictures(self, scene: Scene) -> None:
        """Show a scene in the pictures below the rows of the settings that they show."""
        self._scene = scene
        for picture in self._pictures:
            picture.show_scene(scene)

    def light(self, paths: tuple[str, ...]) -> None:
        """Light the rows of these fields and no others."""
        self._lit = paths
        for path, row in self._rows.items():
            light(row.label, path in paths)

    @property
    def shows_more(self) -> bool:
        """Whether the rare fields are shown."""
        return self._shows_more if self._more is None else self._more.isChecked()

    def reveal(self, path: str) -> None:
        """Unfold what hides the row of a field."""
        self.unfold(True)
        if self._paths[path] and self.more is not None:
            self.more.setChecked(True)

    def _add_more(self, column: QVBoxLayout, rare: list[Parameter], signals: RowSignals, shown: bool) -> None:
        """Add the rare fields below a button that shows and hides them."""
        tip = "Fields that are rarely changed"
        self._more = more = make(QToolButton, objectName="more", checkable=True, toolTip=tip)
        below = QWidget()
        grid = self._grid(rare, signals)
        below.setLayout(grid)
        column.addWidget(more)
        column.addWidget(below)  # without a parent it would be shown as a window

        def show(on: bool) -> None:
            below.setVisible(on)
            more.setText("▾ fewer" if on else f"▸ more ({len(rare)})")

        more.setChecked(shown)
        show(shown)
        more.toggled.connect(show)

    def _grid(self, parameters: list[Parameter], signals: RowSignals) -> QGridLayout:
        """Lay rows out in three columns."""
        grid = QGridLayout()
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(8)
        grid.setVerticalSpacing(4)
        grid.setColumnStretch(1, 1)
        for line, parameter in enumerate(parameters):
            row = _row(parameter, signals)
            fill_grid(grid, [row.parts], 3, 2 * line)
            self._rows[parameter.path] = row
        return grid


def _pictures(parameters: list[Parameter], grid: QGridLayout, signals: RowSignals) -> list[SettingPicture]:
    """Place the pictures of a section, each below the last row of its setting; rows fill every other line."""
    placed = []
    for path, picture in pictures_of_settings().items():
        lines = [line for line, parameter in enumerate(parameters) if parameter.path.startswith(f"{path}.")]
        if lines:
            grid.addWidget(picture, 2 * lines[-1] + 1, 0, 1, 3)
            picture.dragged.connect(signals.dragged)
            picture.settled.connect(signals.settled)
            placed.append(picture)
    return placed


def make_tool(name: str, text: str, tip: str, act: Callable[[], None]) -> QToolButton:
    """Make a button for beside the heading of a section."""
    button = make(QToolButton, objectName=name, text=text, toolTip=tip, accessibleName=tip)
    button.setFixedWidth(TOOL)
    button.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Expanding)
    button.clicked.connect(act)
    return button


def _side_by_side(tools: list[QToolButton]) -> QWidget:
    widget = QWidget()
    fill(QHBoxLayout(widget), *tools, margins=(0, 0, 0, 0), spacing=2)
    return widget


def _row(parameter: Parameter, signals: RowSignals) -> Row:
    """Make the row of a field."""
    if isinstance(parameter, NumberField):
        return NumberRow(parameter, signals.dragged.emit, signals.settled.emit)
    if isinstance(parameter, ChoiceField):
        return ChoiceRow(parameter, signals.settled.emit)
    return FileRow(parameter, signals.file_asked.emit)
