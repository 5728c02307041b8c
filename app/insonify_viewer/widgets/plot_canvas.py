"""Canvas of plots by pyqtgraph, in the colours of the theme; loaded when the first plot comes into view."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyqtgraph as pg
from pyqtgraph.exporters import CSVExporter
from PySide6.QtCore import QPointF, QRectF, QSizeF, Qt
from PySide6.QtGui import QColor, QPen, QWheelEvent

from insonify.arrays import Reals
from insonify_viewer.widgets.theme import EDGE, GROUND, QUIET

pg.setConfigOptions(antialias=True, imageAxisOrder="row-major")

Colour = QColor | str
Ends = tuple[float, float]


class Axis(pg.AxisItem):
    """Axis with true minus signs, and a unit behind its numbers where there is room for no words."""

    def __init__(self, side: str) -> None:
        super().__init__(side)
        self.setStyle(hideOverlappingLabels=False)
        self.enableAutoSIPrefix(False)
        self.unit = ""

    def tickStrings(self, values: Any, scale: float, spacing: float) -> list[str]:
        """Write the numbers of the ticks."""
        texts = super().tickStrings(values, scale, spacing)
        return [f"{text}{self.unit}".replace("-", "−") for text in texts]


class Canvas(pg.PlotWidget):
    """A plot with axes that a subclass of `Plot` fills, in coordinates of its data."""

    def __init__(self, *, still: bool) -> None:
        super().__init__(axisItems={side: Axis(side) for side in ("left", "bottom", "top")}, enableMenu=False)
        self._still = still
        self._taken: list[QRectF] = []  # by words, px
        for widget in (self, self.viewport()):
            widget.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setFrameShape(self.Shape.NoFrame)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.NoContextMenu)  # that of the plot is shown
        self.hideButtons()
        self.setMouseEnabled(not still, not still)
        self.plotItem.layout.setContentsMargins(2, 4, 16, 2)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Zoom, or let what is around scroll."""
        if self._still:
            event.ignore()
        else:
            super().wheelEvent(event)

    def begin(self, x: str, y: str, ground: Colour, *, grid: bool) -> None:
        """Remove what is drawn, and take colours and text of the theme."""
        self.clear()
        self._taken = []
        self.setBackground(QColor(GROUND))
        self.plotItem.vb.setBackgroundColor(QColor(ground))
        self.hideAxis("top")
        for side, words in (("bottom", x), ("left", y), ("top", "")):
            axis = self.getAxis(side)
            axis.setPen(QColor(EDGE if not grid else QUIET))
            axis.setTextPen(QColor(QUIET))
            axis.setTickFont(self.font())
            axis.setGrid(70 if grid and side != "top" else False)
            size = self.font().pointSizeF()
            axis.setLabel(words, color=QUIET.name(), **{"font-size": f"{size:g}pt"})
            axis.showLabel(bool(words))

    def number(self, side: str, ticks: Sequence[tuple[float, str]]) -> None:
        """Write texts at some places of an axis, in place of round numbers."""
        self.getAxis(side).setTicks([ticks])

    def number_above(self, ticks: Sequence[tuple[float, str]], words: str) -> None:
        """Show an upper axis with texts at some places, and name it."""
        self.showAxis("top")
        self.number("top", ticks)
        self.getAxis("top").setLabel(words)

    def unit(self, side: str, unit: str) -> None:
        """Write a unit behind the numbers of an axis."""
        self.getAxis(side).unit = unit if unit in ("", "°") else f" {unit}"

    def line(self, x: Reals, y: Reals, colour: Colour, width: float = 1.5, *, name: str | None = None,
             style: Qt.PenStyle = Qt.PenStyle.SolidLine, segments: bool = False) -> None:  # fmt: skip
        """Draw a line through the points that are finite, or a segment for every two points."""
        pen = pg.mkPen(QColor(colour), width=width, style=style)
        self.plot(x, y, pen=pen, name=name, connect="pairs" if segments else "finite", autoDownsample=False)

    def area(self, x: Reals, y: Reals, base: float, colour: Colour) -> None:
        """Fill what lies between a line and a level."""
        self.plot(x, y, pen=None, fillLevel=base, fillBrush=QColor(colour))

    def dots(
        self, points: Any, fill: Colour | None, size: float, edge: Colour | None = None, width: float = 1.0
    ) -> None:
        """Draw round marks, or rings, with a diameter in px at points, (n, 2)."""
        x, y = np.reshape(np.asarray(points, float), (-1, 2)).T
        pen = None if edge is None else pg.mkPen(QColor(edge), width=width)
        self.addItem(pg.ScatterPlotItem(x, y, size=size, brush=None if fill is None else QColor(fill), pen=pen))

    def picture(self, pixels: Any, x: Ends, y: Ends, *, levels: Any = None, lut: Any = None) -> None:
        """Lay a picture over a rectangle; its first row lies at the first y."""
        item = pg.ImageItem(pixels, levels=levels, lut=lut)
        item.setRect(QRectF(x[0], y[0], x[1] - x[0], y[1] - y[0]))
        item.setZValue(-10)
        self.addItem(item)

    def words(self, text: str, x: float, y: float, colour: Colour, anchor: Ends = (0.5, 0.5)) -> None:
        """Write at a place unless other words are there; the anchor is the part of the text that lies at the place."""
        size = self.fontMetrics().size(0, text)
        corner = self.place_of(x, y) - QPointF(anchor[0] * size.width(), anchor[1] * size.height())
        room = QRectF(corner, QSizeF(size))
        if any(room.intersects(other) for other in self._taken):
            return
        self._taken.append(room)
        item = pg.TextItem(text, color=QColor(colour), anchor=anchor)
        item.setFont(self.font())
        self.addItem(item, ignoreBounds=True)
        item.setPos(x, y)

    def rule(self, at: float, colour: Colour, *, upright: bool = True, style: Qt.PenStyle = Qt.PenStyle.DotLine) -> Any:
        """Draw a line across the plot; `setValue` of what is returned moves it."""
        rule = pg.InfiniteLine(at, angle=90 if upright else 0, pen=QPen(QColor(colour), 1.0, style))
        rule.pen.setCosmetic(True)
        self.addItem(rule, ignoreBounds=True)
        return rule

    def name_lines(self, corner: Ends = (-6.0, 4.0)) -> None:
        """Name the lines that follow in a corner, the upper right one unless another is given."""
        known = self.plotItem.legend
        legend = self.addLegend(offset=corner, colCount=4) if known is None else known
        legend.layout.setContentsMargins(4, 0, 4, 0)
        legend.clear()
        legend.setBrush(QColor(GROUND.red(), GROUND.green(), GROUND.blue(), 190))
        legend.setLabelTextColor(QColor(QUIET))
        legend.setLabelTextSize(f"{self.font().pointSizeF():g}pt")

    def at(self, place: QPointF) -> tuple[float, float]:
        """Coordinates of a place in px."""
        point = self.plotItem.vb.mapSceneToView(self.mapToScene(place.toPoint()))
        return point.x(), point.y()

    def place_of(self, x: float, y: float) -> QPointF:
        """Place of a point in px."""
        return QPointF(self.mapFromScene(self.plotItem.vb.mapViewToScene(QPointF(x, y))))

    def save_table(self, path: str) -> None:
        """Write the points of all lines as CSV."""
        CSVExporter(self.plotItem).export(path)
