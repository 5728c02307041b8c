"""Questions before surveys and data sets are made."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PySide6.QtCore import QLineF, QPointF, QSize, Qt
from PySide6.QtGui import QColor, QPainter, QPen, QTransform
from PySide6.QtWidgets import (
    QAbstractItemView,
    QComboBox,
    QDoubleSpinBox,
    QFileDialog,
    QGraphicsScene,
    QGraphicsView,
    QHeaderView,
    QLineEdit,
    QSpinBox,
    QTableWidget,
    QTableWidgetItem,
    QWidget,
)

from insonify.scene import Scene
from insonify.scene.edit import parse_quantity
from insonify.surveys import OVERLAPS
from insonify.surveys.lines.specification import Area
from insonify.surveys.lines.work import SurveyLine, lay_lawnmower
from insonify.tow.line import tow_line_at
from insonify_viewer.state.fields import NumberField
from insonify_viewer.state.quantities import format_quantity, format_time_left
from insonify_viewer.state.sections import FieldSection
from insonify_viewer.widgets.buttons import make, make_label
from insonify_viewer.widgets.question import Question
from insonify_viewer.widgets.theme import ACCENT

MOST_SCENES, USUAL_SCENES = 1_000_000, 20
MAP, DOT, SHOWN = QSize(360, 240), 6.0, 55  # px, px, opacity of a swath of 255
TABLE = QSize(440, 260)
WIDEST = 100_000.0  # m, of an area
PRESENT = "this scene"


class FolderQuestion(Question):
    """Asks for what makes a folder."""

    def __init__(self, title: str, name: str, parent: QWidget) -> None:
        super().__init__(title, parent)
        self._folder = make(QLineEdit, str(Path.home() / name), objectName="line")

    @property
    def folder(self) -> Path:
        """The folder to make, or to continue."""
        return Path(self._folder.text())

    def end(self) -> None:
        """Add the row of the folder, and the buttons."""
        self.add("Folder", self._folder, "A new folder, or one that was begun and is then continued", self._ask)
        super().end()

    def _ask(self) -> None:
        if folder := QFileDialog.getExistingDirectory(self, "Choose the folder", self._folder.text()):
            self._folder.setText(folder)


class SurveyQuestion(FolderQuestion):
    """Asks for the area and the lines of a survey of a scene, and shows them on a map."""

    def __init__(self, scene: Scene, parent: QWidget) -> None:
        super().__init__("Survey the scene", "survey", parent)
        self._scene = scene
        tow = tow_line_at(scene, np.array([0, scene.track.pings - 1]))
        self._start = float(tow.x[0]), float(tow.y[0])
        self._reach = math.sqrt(max(scene.sonar.range**2 - scene.altitude**2, 0.0))
        length = max(math.dist(*zip(tow.x, tow.y, strict=True)), 2.0 * self._reach)
        self._map = make(QGraphicsView, QGraphicsScene(self), interactive=False, focusPolicy=Qt.FocusPolicy.NoFocus)
        self._map.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._map.setMinimumSize(MAP)
        self._map.setAccessibleName("Map of the lines")
        self._map.viewport().setAccessibleName("Map of the lines")
        self._sum = make_label("name")
        self.length, self.width_, self.spacing = (
            _spin(value, 0.1, WIDEST, " m") for value in (length, 4.0 * self._reach, 1.5 * self._reach)
        )
        self.heading = _spin(math.degrees(float(tow.heading[0])), -360.0, 360.0, "°")
        self.overlap = QComboBox()
        self.overlap.addItems(OVERLAPS)
        self.form.addRow(self._map)
        self.form.addRow(self._sum)
        self.add("Length", self.length, "Length of the area along the lines, from the first ping of the scene on")
        self.add("Width", self.width_, "Width of the area, half of it to each side of the first ping")
        self.add("Line spacing", self.spacing, f"Distance between lines; the sonar reaches {self._reach:.3g} m")
        self.add("Heading", self.heading, "Direction of the first line, counter-clockwise from +x (east)")
        self.add("Overlap", self.overlap, "What counts in the mosaic where records overlap")
        self.end()
        for spin in (self.length, self.width_, self.spacing, self.heading):
            spin.valueChanged.connect(self._show)
        self._show()

    @property
    def answer(self) -> dict[str, Any]:
        """Specification of the survey."""
        area = self._area.model_dump(mode="json")
        return {"title": self._scene.title, "area": area, "mosaic": {"overlap": self.overlap.currentText()}}

    @property
    def _area(self) -> Area:
        turn = math.radians(self.heading.value())
        ahead, aside = np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)])
        sides = (0.0, -0.5), (1.0, -0.5), (1.0, 0.5), (0.0, 0.5)
        edge = [self._start + u * self.length.value() * ahead + v * self.width_.value() * aside for u, v in sides]
        corners = tuple((float(x), float(y)) for x, y in edge)
        return Area(corners=corners, spacing=self.spacing.value(), heading=self.heading.value())

    def _show(self) -> None:
        """Show the lines and what they cost."""
        area = self._area
        lines = lay_lawnmower(area)
        self._draw(area, lines)
        towed = sum(line.length for line in lines)
        time = format_time_left(towed / self._scene.track.speed)
        self._sum.setText(f"{len(lines)} lines, {towed:.4g} m of towing in {time}; dots are targets, north is up.")

    def _draw(self, area: Area, lines: list[SurveyLine]) -> None:
        """Draw the lines with their swaths and where they begin, the area, and the targets; north is up."""
        chart, accent, swath, ink = self._map.scene(), QColor(ACCENT), QColor(ACCENT), self.palette().text().color()
        swath.setAlpha(SHOWN)
        chart.clear()
        for line in lines:
            along = QLineF(*line.start, *line.end)
            chart.addLine(along, QPen(swath, 2.0 * self._reach, Qt.PenStyle.SolidLine, Qt.PenCapStyle.FlatCap))
            chart.addLine(along, QPen(accent, 0.0))
        chart.addPolygon([QPointF(*corner) for corner in area.corners], QPen(ink, 0.0, Qt.PenStyle.DashLine))
        box = chart.itemsBoundingRect()
        scale = min(MAP.width() / box.width(), MAP.height() / box.height())
        size = DOT / scale
        dots = [(line.start, accent) for line in lines] + [(target.position[:2], ink) for target in self._scene.targets]
        for (x, y), colour in dots:
            chart.addEllipse(x - size / 2.0, y - size / 2.0, size, size, QPen(colour, 0.0), colour)
        chart.setSceneRect(box)
        self._map.setTransform(QTransform.fromScale(scale, -scale))


class DatasetQuestion(FolderQuestion):
    """Asks for a data set, by a specification or of the present scene with fields drawn from ranges."""

    def __init__(self, bundled: list[str], sections: Sequence[FieldSection], parent: QWidget) -> None:
        super().__init__("Make a data set", "dataset", parent)
        self.specification = make(QComboBox, editable=True)
        self.specification.addItems([PRESENT, *bundled])
        self.scenes = make(QSpinBox, minimum=1, maximum=MOST_SCENES, value=USUAL_SCENES)
        self._fields = [
            field
            for section in sections
            if not section.removable  # targets are put elsewhere, as they are
            for field in section.parameters
            if isinstance(field, NumberField) and field.slider is not None and not field.idle
        ]
        self.drawn = QTableWidget(len(self._fields), 3)
        self.drawn.setMinimumSize(TABLE)
        self.drawn.setHorizontalHeaderLabels(["field", "from", "to"])
        self.drawn.verticalHeader().hide()
        self.drawn.horizontalHeader().setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.drawn.setTabKeyNavigation(False)  # Tab goes on to the next row of the form
        self.drawn.setEditTriggers(QAbstractItemView.EditTrigger.AllEditTriggers)
        for row, field in enumerate(self._fields):
            value = format_quantity(field.value, field.unit)
            for column, text in enumerate((field.name, value, value)):
                item = QTableWidgetItem(text)
                item.setToolTip(field.about)
                if column == 0:
                    item.setFlags(Qt.ItemFlag.ItemIsEnabled)
                self.drawn.setItem(row, column, item)
        tip = f"{PRESENT} with its targets at other places, a bundled specification, or the path of a TOML file"
        self.add("Specification", self.specification, tip, self._choose_file)
        self.add("Drawn", self.drawn, "Where the two values differ, every scene draws one between them")
        self.add("Scenes", self.scenes, f"Number of random scenes, 1 to {MOST_SCENES}")
        self.end()
        self.specification.currentTextChanged.connect(lambda text: self.drawn.setEnabled(text == PRESENT))

    @property
    def specification_name(self) -> str:
        """Name of a bundled specification or path of a file; empty for the present scene."""
        text = self.specification.currentText()
        return "" if text == PRESENT else text

    @property
    def ranges(self) -> dict[str, Any]:
        """Distributions of the fields that are drawn, by their paths."""
        found = {}
        for row, field in enumerate(self._fields):
            texts = [item.text() for column in (1, 2) if (item := self.drawn.item(row, column))]
            if texts[0] != texts[1]:
                shown = format_quantity(field.value, field.unit)
                low, high = (_number(text, field, shown) for text in texts)
                kind = "integers" if field.integer else "log_uniform" if field.log else "uniform"
                found[field.path] = {"draw": kind, "low": low, "high": high}
        return found

    def _choose_file(self) -> None:
        file, _ = QFileDialog.getOpenFileName(self, "Open a specification", "", "Specifications (*.toml)")
        if file:
            self.specification.setCurrentText(file)


def _spin(value: float, low: float, high: float, unit: str) -> QDoubleSpinBox:
    """Field of a number with its unit."""
    return make(QDoubleSpinBox, decimals=1, minimum=low, maximum=high, suffix=unit, value=value)


def _number(text: str, field: NumberField, shown: str) -> float | int | str:
    """Return the number that a person wrote; its text where it is none, which the command refuses in a sentence."""
    value = parse_quantity(text, field.unit, like=shown)
    return text if value is None else round(value) if field.integer else value
