"""Window of the chart: speed against accuracy, and the record behind each point."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRect, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QImage, QKeyEvent, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QProgressBar, QVBoxLayout, QWidget

from insonify.arrays import Singles
from insonify.display.display_options import PALETTES
from insonify.display.picture import choose_contrast, colour_rows, load_palette
from insonify_viewer.panels.chart.chart_details import ChartPicture, RowDetails, details_in_words, nearest_row
from insonify_viewer.state.quantities import format_time_left
from insonify_viewer.widgets.buttons import make_label, push_button
from insonify_viewer.widgets.layouts import fill, make_splitter
from insonify_viewer.widgets.painting import Painted, colour_table, column_means, image_of, round_steps, two_sided_table
from insonify_viewer.widgets.text import window_title
from insonify_viewer.widgets.theme import ACCENT, EDGE, GROUND, MARK, QUIET, TEXT

SIZE, SMALLEST = (1120, 860), (560, 460)
STRIPS, MOST = 320, 0.42  # px, first height of the strips, and their greatest share of the window's height
GRASP = 14.0  # px, greatest distance at which a point is picked
FORMATS = "Picture (*.png);;Drawing (*.svg);;Table (*.csv);;Table (*.json)"
INVITATION = (
    "“Measure here” runs every simulation method on this scene. The chart then shows how long each takes, and how far "
    "its record is from an exact one. It takes a minute or two."
)
BUSY = "measuring with the tow paused; other programs that run now make the times longer …"
HINT = "Click a point, or press ← → in the chart, to see its record beside the exact one, and their difference."
LEFT, RIGHT, TITLE, RULER = 12, 12, 18, 28  # px
DIFFERENCE = (
    ("difference, in full colour where it is half the span of the picture: ", TEXT),
    *(("too bright", ACCENT), (" or ", TEXT), ("too dark", MARK)),
)
LARGE = 0.5  # of the span of the palette: the difference drawn in full colour


class ChartWindow(QWidget):
    """Shows a chart, and signals the point that the person picks."""

    picked = Signal(object)  # AccuracyRow

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("panel")
        self.setWindowTitle("Chart · insonify")
        self.resize(*SIZE)
        self.setMinimumSize(*SMALLEST)
        self.measure = push_button("Measure here", "Measure speed and error of every method on this scene")
        self.stop = push_button("Stop", "Stop the measurement")
        self.save = push_button("Save…", "Save the chart as a picture or a table: .png, .svg, .csv or .json")
        self._progress = QProgressBar(maximum=1000, textVisible=False)
        self._sentence, self._numbers = make_label("name", INVITATION), make_label("numbers")
        self.picture, self._strips = _ChartPictureView(), StripsView()
        self._lay_out()
        self.picture.picked.connect(self.picked)
        self.save.setEnabled(False)
        self.show_busy(False)

    def show_busy(self, busy: bool) -> None:
        """Enable stopping during a measurement, and starting otherwise."""
        self.measure.setEnabled(not busy)
        self.stop.setEnabled(busy)
        self._progress.setVisible(busy)
        if busy:
            self._progress.setValue(0)
            self.say(BUSY)

    def show_progress(self, share: float, seconds_left: float | None) -> None:
        """Show the share of the measurement that is done, and the time left if that is known."""
        self._progress.setValue(round(1000.0 * share))
        self.say(BUSY if seconds_left is None else f"{format_time_left(seconds_left)} left: {BUSY}")

    def show_chart(self, chart_picture: ChartPicture) -> None:
        """Show a measured chart."""
        self.setWindowTitle(f"Chart of {window_title(chart_picture.chart.title) or 'an untitled scene'} · insonify")
        self.picture.show_chart(chart_picture)
        self._bottom.hide()
        self.save.setEnabled(True)
        self.say(HINT)

    def show_details(self, details: RowDetails) -> None:
        """Show the record behind a point."""
        if self._bottom.isHidden():
            self._bottom.show()
            height = self._splitter.height()
            strips = min(STRIPS, round(MOST * height))
            self._splitter.setSizes([height - strips, strips])
        self._strips.show_details(details)
        self._numbers.setText(details_in_words(details))
        self.picture.show_chosen(details.row)

    def say(self, sentence: str) -> None:
        """Show a sentence until the next one."""
        self._sentence.setText(sentence)

    def ask_where_to_save(self) -> str:
        """Let the person name a file; return its path, empty if none was named."""
        return QFileDialog.getSaveFileName(self, "Save the chart", "chart.png", FORMATS)[0]

    def _lay_out(self) -> None:
        tools = self.measure, self.stop, self.save, self._progress
        top = fill(QHBoxLayout(), *tools, self._sentence, growing=self._sentence)
        self._bottom = QWidget()
        below = QVBoxLayout(self._bottom)
        fill(below, self._strips, self._numbers, growing=self._strips, margins=(0, 4, 0, 0))
        self._bottom.hide()
        self._splitter = make_splitter(Qt.Orientation.Vertical, self.picture, self._bottom)
        self._splitter.setStretchFactor(0, 1)
        fill(QVBoxLayout(self), top, self._splitter, growing=self._splitter)


class _ChartPictureView(Painted):
    """The picture of the chart, as large as fits."""

    picked = Signal(object)

    def __init__(self) -> None:
        reached = Qt.FocusPolicy.TabFocus
        super().__init__(minimumSize=QSize(320, 180), mouseTracking=True, focusPolicy=reached, accessibleName="Chart")
        self._chart_picture: ChartPicture | None = None
        self._image = QImage()
        self._chosen: object = None
        self.setToolTip("Click a point, or step through the points with ← →, to see its record")

    def show_chart(self, chart_picture: ChartPicture) -> None:
        self._chart_picture, self._chosen = chart_picture, None
        self._image = image_of(chart_picture.pixels)
        self.update()

    def show_chosen(self, row: object) -> None:
        self._chosen = row
        self.update()

    def place_of(self, row: object) -> QPointF:
        """Pixel of a row's point."""
        assert self._chart_picture is not None
        frame = self._frame()
        point = next(point for point in self._chart_picture.points if point.row is row)
        return QPointF(frame.left() + point.x * frame.width(), frame.top() + point.y * frame.height())

    def paint(self, painter: QPainter) -> None:
        """Draw the chart, and a ring around the picked point."""
        painter.fillRect(self.rect(), QColor(GROUND))
        painter.setRenderHints(QPainter.RenderHint.SmoothPixmapTransform | QPainter.RenderHint.Antialiasing)
        if self._chart_picture is None:
            painter.setPen(QColor(QUIET))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "nothing measured yet")
        else:
            painter.drawImage(self._frame(), self._image)
            if self._chosen is not None:
                painter.setPen(QPen(QColor(ACCENT), 3))
                painter.drawEllipse(self.place_of(self._chosen), 9.0, 9.0)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Signal the point under the mouse."""
        if (row := self._under(event.position())) is not None:
            self.picked.emit(row)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Signal the point before or after the chosen one; the first one if none is chosen."""
        turn = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}.get(Qt.Key(event.key()))
        if turn is None or self._chart_picture is None or not self._chart_picture.points:
            super().keyPressEvent(event)
            return
        rows = [point.row for point in self._chart_picture.points]
        at = next((number for number, row in enumerate(rows) if row is self._chosen), None)
        self.picked.emit(rows[0 if at is None else (at + turn) % len(rows)])

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Change the cursor over a point."""
        over = self._under(event.position()) is not None
        self.setCursor(Qt.CursorShape.PointingHandCursor if over else Qt.CursorShape.ArrowCursor)

    def _under(self, place: QPointF) -> object:
        if self._chart_picture is None:
            return None
        frame = self._frame()
        x, y = (place.x() - frame.left()) / frame.width(), (place.y() - frame.top()) / frame.height()
        return nearest_row(self._chart_picture.points, x, y, frame.height() / frame.width(), GRASP / frame.width())

    def _frame(self) -> QRectF:
        """Rectangle of the picture in the widget."""
        scale = min(self.width() / self._image.width(), self.height() / self._image.height())
        width, height = scale * self._image.width(), scale * self._image.height()
        return QRectF((self.width() - width) / 2.0, (self.height() - height) / 2.0, width, height)


class StripsView(Painted):
    """Shows the record behind a point of a chart."""

    def __init__(self) -> None:
        super().__init__(minimumHeight=3 * (TITLE + 16) + RULER)
        self._details: RowDetails | None = None

    def show_details(self, details: RowDetails) -> None:
        """Show a record beside its reference."""
        self._details = details
        self.update()

    def paint(self, painter: QPainter) -> None:
        """Draw the strips with their titles, and the ruler."""
        painter.fillRect(self.rect(), QColor(GROUND))
        if (details := self._details) is not None:
            low, high = choose_contrast(details.reference)
            shades = colour_table(load_palette(PALETTES[0]))
            largest = LARGE * (high - low)
            record = ((f"record: {details.row.method}, {details.row.setting}", TEXT),)
            exact = ((f"exact: {details.rays:,} rays a side", TEXT),)
            self._draw(painter, 0, record, details.record, (low, high), shades)
            self._draw(painter, 1, exact, details.reference, (low, high), shades)
            moved = details.record - details.reference
            self._draw(painter, 2, DIFFERENCE, moved, (-largest, largest), two_sided_table())
            self._draw_ruler(painter, details.reach)

    def _draw(
        self,
        painter: QPainter,
        number: int,
        title: tuple[tuple[str, QColor], ...],
        strip: Singles,
        ends: tuple[float, float],
        table: NDArray[np.uint32],
    ) -> None:
        place = self._place(number)
        line = place.adjusted(0, -TITLE, 0, 0)
        for words, colour in title:
            painter.setPen(QColor(colour))
            painter.drawText(line, Qt.AlignmentFlag.AlignLeft, words)
            line.setLeft(line.left() + painter.fontMetrics().horizontalAdvance(words))
        pixels = colour_rows(column_means(strip, place.width()), *ends, table)
        rows, width = pixels.shape
        painter.drawImage(place, QImage(pixels.data, width, rows, 4 * width, QImage.Format.Format_RGB32))

    def _place(self, number: int) -> QRect:
        """Rectangle of a strip."""
        tall = (self.height() - RULER) / 3.0
        top = round(number * tall) + TITLE
        return QRect(LEFT, top, max(self.width() - LEFT - RIGHT, 2), max(round((number + 1) * tall) - top - 2, 1))

    def _draw_ruler(self, painter: QPainter, reach: float) -> None:
        """Draw metres of slant range from nadir to both sides."""
        last = self._place(2)
        middle, base = last.left() + last.width() / 2.0, last.bottom() + 2
        for value in round_steps(0.0, reach, max(last.width() // 160, 1)):
            for x in {middle - value / reach * last.width() / 2.0, middle + value / reach * last.width() / 2.0}:
                painter.setPen(QColor(EDGE))
                painter.drawLine(int(x), base, int(x), base + 4)
                painter.setPen(QColor(QUIET))
                unit = " m" if value == 0.0 else ""
                painter.drawText(
                    QRect(int(x) - 40, base + 5, 80, 15), Qt.AlignmentFlag.AlignHCenter, f"{value:g}{unit}"
                )
