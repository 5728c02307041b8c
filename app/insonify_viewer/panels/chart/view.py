"""Window of the chart: speed against accuracy, and the record behind each point."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from PySide6.QtCore import QPointF, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFileDialog, QHBoxLayout, QProgressBar, QVBoxLayout, QWidget

from insonify.display.display_options import PALETTES
from insonify.display.picture import choose_contrast, load_palette
from insonify_viewer.core_types import AccuracyChart
from insonify_viewer.panels.chart.chart_details import FLOOR, RowDetails, details_in_words, place_of_row
from insonify_viewer.state.quantities import format_duration, format_time_left, nearest_within
from insonify_viewer.widgets.buttons import make_label, push_button
from insonify_viewer.widgets.layouts import fill, make_splitter
from insonify_viewer.widgets.painting import round_steps, two_sided_palette
from insonify_viewer.widgets.plot import Canvas, Plot
from insonify_viewer.widgets.text import window_title
from insonify_viewer.widgets.theme import ACCENT, EDGE, MARK, OVER_WATER, QUIET, TEXT

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
DIFFERENCE = (ACCENT, "too bright"), (MARK, "too dark")
PLAN = "default plan"
WITH = {False: "without targets", True: "with targets"}
FAMILIES = {"march": "#c07a3a", "rays": "#4a90c8", "sweep": "#2fa36b", "embree": "#9a78c8"}  # colours of methods
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
        self.sentence, self.numbers = make_label("name", INVITATION), make_label("numbers")
        self._summary = make_label("name")
        self._summary.hide()
        self.picture, self.strips = ChartPlots(), StripsView()
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

    def show_chart(self, chart: AccuracyChart) -> None:
        """Show a measured chart."""
        self.setWindowTitle(f"Chart of {window_title(chart.title) or 'an untitled scene'} · insonify")
        self.picture.show_chart(chart)
        self._summary.setText("\n".join(chart.summarise()))
        self._summary.show()
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
        self.strips.show_details(details)
        self.numbers.setText(details_in_words(details))
        self.picture.show_chosen(details.row)

    def say(self, sentence: str) -> None:
        """Show a sentence until the next one."""
        self.sentence.setText(sentence)

    def ask_where_to_save(self) -> str:
        """Let the person name a file; return its path, empty if none was named."""
        return QFileDialog.getSaveFileName(self, "Save the chart", "chart.png", FORMATS)[0]

    def _lay_out(self) -> None:
        tools = self.measure, self.stop, self.save, self._progress
        top = fill(QHBoxLayout(), *tools, self.sentence, growing=self.sentence)
        self._bottom = QWidget()
        below = QVBoxLayout(self._bottom)
        fill(below, self.strips, self.numbers, growing=self.strips, margins=(0, 4, 0, 0))
        self._bottom.hide()
        self._splitter = make_splitter(Qt.Orientation.Vertical, self.picture, self._bottom)
        self._splitter.setStretchFactor(0, 1)
        fill(QVBoxLayout(self), top, self._summary, self._splitter, growing=self._splitter)


class ChartPlots(QWidget):
    """The chart without targets and with them, side by side; a click or keys pick a point."""

    picked = Signal(object)

    def __init__(self) -> None:
        super().__init__(minimumSize=QSize(320, 180), focusPolicy=Qt.FocusPolicy.TabFocus, accessibleName="Chart")
        self.setToolTip("Click a point, or step through the points with ← →, to see its record")
        self.chart: AccuracyChart | None = None
        self.chosen: object = None
        self.plots = {targets: ScenePlot(self, targets) for targets in (False, True)}
        fill(QHBoxLayout(self), *self.plots.values(), margins=(0, 0, 0, 0), spacing=2)
        for targets, plot in self.plots.items():
            plot.clicked.connect(lambda x, y, plot=plot: self._pick_near(plot, x, y))
            plot.setVisible(not targets)

    def show_chart(self, chart: AccuracyChart) -> None:
        """Show a chart."""
        self.chart = chart
        for targets, plot in self.plots.items():
            plot.setVisible(targets in chart.scenes)
        self.show_chosen(None)

    def show_chosen(self, row: object) -> None:
        """Show which row is chosen."""
        self.chosen = row
        for plot in self.plots.values():
            plot.redraw()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Signal the point before or after the chosen one; the first one if none is chosen."""
        turn = {Qt.Key.Key_Left: -1, Qt.Key.Key_Right: 1}.get(Qt.Key(event.key()))
        if turn is None or self.chart is None or not self.chart.rows:
            super().keyPressEvent(event)
            return
        rows = self.chart.rows
        at = next((number for number, row in enumerate(rows) if row is self.chosen), None)
        self.picked.emit(rows[0 if at is None else (at + turn) % len(rows)])

    def _pick_near(self, plot: ScenePlot, x: float, y: float) -> None:
        """Signal the row that is drawn nearest to a place."""
        place, rows = QPointF(plot.place_of(x, y)), [] if self.chart is None else self.chart.rows_of(plot.targets)
        nearest = nearest_within([plot.distance(place_of_row(row), place) for row in rows], GRASP)
        if nearest is not None:
            self.picked.emit(rows[nearest])


class ScenePlot(Plot):
    """Error over time of every method on the scene with its targets, or without."""

    def __init__(self, chart: ChartPlots, targets: bool) -> None:
        super().__init__(f"Error over time {WITH[targets]}", y="error beyond 1.4 × altitude")
        self._chart, self.targets = chart, targets

    def draw(self, canvas: Canvas) -> None:
        """Draw lines through the settings of each method, the best for their time, and what is not resolved."""
        # lazy: loads Matplotlib; by now the chart has loaded it
        from insonify.accuracy.charts.kinds.accuracy import RECORD, TOLERANCE

        chart = self._chart.chart
        if chart is None:
            self.say((OVER_WATER, "nothing measured yet"))
            return
        rows, reference = chart.rows_of(self.targets), chart.scenes[self.targets].reference
        one = len(chart.scenes) == 1
        self.words = f"time per ping{'' if one else ' ' + WITH[self.targets]}", self.words[1]
        canvas.number("bottom", [(k, format_duration(10.0 ** (k - 6))) for k in range(-1, 9)])
        canvas.number("left", [(k, f"{10.0 ** (k + 2):g} %") for k in range(-5, 2)])
        whole = math.log10(RECORD)
        canvas.number_above([(k - whole, format_duration(10.0 ** (k - 6))) for k in range(2, 12)], f"{RECORD} pings")
        times, errors = np.array([place_of_row(row) for row in chart.rows]).T
        low, high = (errors.min() - 0.5, errors.max() + 0.6)
        ends = float(times.min() - 0.3), float(times.max() + 0.3)
        floor = math.log10(max(reference.floor, FLOOR))
        canvas.area(np.array(ends), np.full(2, floor), low, EDGE)
        canvas.rule(math.log10(TOLERANCE), QUIET, upright=False)
        canvas.words(f"tolerance {100.0 * TOLERANCE:g} %", ends[0], math.log10(TOLERANCE), QUIET, (-0.1, 1.0))
        front = np.array([place_of_row(row) for row in chart.find_front(self.targets)]).reshape(-1, 2).T
        canvas.line(front[0], front[1], EDGE, 7.0)
        canvas.name_lines((6.0, -4.0))
        for method in dict.fromkeys(row.method for row in rows):
            points = np.array([place_of_row(row) for row in rows if row.method == method])
            family = method.partition(",")[0]
            colour = FAMILIES.get(family, TEXT)
            usual = method in (family, PLAN)
            canvas.line(points[:, 0], points[:, 1], colour, 1.5 if usual else 0.7, name=family if usual else None)
            canvas.dots(points, colour, 8.0 if usual else 5.0)
        for row in rows:
            if row.method in FAMILIES:
                canvas.words(row.label, *place_of_row(row), QUIET, (0.5, 1.1))
            if row is self._chart.chosen:
                canvas.dots(place_of_row(row), None, 18.0, ACCENT, 3.0)
        self.say()
        self.limit(ends, (float(low), float(high)))


class StripsView(QWidget):
    """Shows the record behind a point of a chart, the exact one, and their difference."""

    def __init__(self) -> None:
        super().__init__()
        self.setMinimumHeight(150)
        self.strips = [StripPlot(last=number == 2) for number in range(3)]
        self._titles = [make_label("figure", form=Qt.TextFormat.RichText) for _ in self.strips]
        column = fill(QVBoxLayout(self), margins=(0, 0, 0, 0), spacing=0)
        for title, strip in zip(self._titles, self.strips):
            column.addWidget(title)
            column.addWidget(strip, 1)

    def show_details(self, details: RowDetails) -> None:
        """Show a record beside its reference."""
        low, high = choose_contrast(details.reference)
        largest, shades = LARGE * (high - low), load_palette(PALETTES[0])
        moved = details.record - details.reference
        bright, dark = (f'<span style="color:{c.name()}">{words}</span>' for c, words in DIFFERENCE)
        rows = (
            (f"record: {details.row.method}, {details.row.setting}", details.record, (low, high), shades),
            (f"exact: {details.rays:,} rays a side", details.reference, (low, high), shades),
            (
                f"difference, in full colour where it is half the span of the picture: {bright} or {dark}",
                *(moved, (-largest, largest), two_sided_palette()),
            ),
        )
        for title, strip, (words, pixels, levels, palette) in zip(self._titles, self.strips, rows):
            title.setText(words)
            strip.show_picture(pixels, levels, palette, details.reach)


class StripPlot(Plot):
    """A record over slant range, port to the left."""

    def __init__(self, *, last: bool) -> None:
        super().__init__("Record of a point of the chart", still=True, grid=False)
        self.setMinimumHeight(40 if last else 16)
        self._last = last
        self._shown: tuple[Any, ...] | None = None

    def show_picture(self, *shown: Any) -> None:
        """Show amplitudes, their levels, the palette, and the greatest slant range."""
        self._shown = shown
        self.redraw()

    def draw(self, canvas: Canvas) -> None:
        """Draw the record."""
        canvas.hideAxis("left")
        canvas.showAxis("bottom", self._last)
        if self._shown is not None:
            pixels, levels, palette, reach = self._shown
            canvas.picture(pixels, (-reach, reach), (0.0, len(pixels)), levels=levels, lut=palette)
            canvas.number(
                "bottom", [(at, f"{abs(at):g}" + " m" * (at == 0.0)) for at in round_steps(-reach, reach, 12)]
            )
            self.limit((-reach, reach), (len(pixels), 0.0))
