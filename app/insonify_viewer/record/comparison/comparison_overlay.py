"""Record A over the live record B: in its place, left of a line that is dragged, or as the difference of both."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QRectF, Qt
from PySide6.QtGui import (
    QColor,
    QImage,
    QKeyEvent,
    QLinearGradient,
    QMouseEvent,
    QPainter,
    QPen,
    QWheelEvent,
)

from insonify.arrays import Booleans, Integers, Singles
from insonify.display.picture import colour_rows
from insonify_viewer.errors import guard_override
from insonify_viewer.record.comparison.arrangement import Arrangement
from insonify_viewer.record.comparison.record_a_view import RecordAView
from insonify_viewer.record.comparison.record_difference import FLOOR
from insonify_viewer.record.record_image import EMPTY
from insonify_viewer.record.waterfall_view import WaterfallView
from insonify_viewer.widgets.arrow_keys import modifiers_of
from insonify_viewer.widgets.painting import Painted, colour_table, draw_veil, two_sided_palette
from insonify_viewer.widgets.theme import ACCENT, ACCENT_IN_WATER, GROUND, MARK, TEXT

GRIP = 6  # px beside the split line in which it is taken hold of
HIGH = 18  # px, of a caption
WIPE = 0.02  # share of the plot by which a key moves the split line
WIPES: dict[int, float] = {Qt.Key.Key_Left: -WIPE, Qt.Key.Key_Right: WIPE}  # with Alt
SPANS = (0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 40.0)  # dB at the ends of the palette
CLIPPED = 0.005  # share of the pixels that may lie beyond the ends
SAMPLED = 7  # every so many pixels are looked at for the span
Columns = tuple[Singles, Booleans]


class ComparisonOverlay(Painted):
    """Lies over the view of record B and draws record A there, at the same scale."""

    # Where it draws nothing, the mouse belongs to record B.

    def __init__(self, a: RecordAView, b: WaterfallView) -> None:
        super().__init__(b)
        self._a, self._b = a, b
        self._titles = ("A", "B")
        self._arrangement = Arrangement.BESIDE  # in which the overlay draws nothing
        self._by_ping = True  # whether rows are paired by their pings, else by the distance from the upper edge
        self._held = self._dragged = False
        self._split = 0.5  # share of the plot that A covers
        self._followed = -1  # version of A that is drawn
        self.difference: DifferencePicture | None = None
        self._difference_of: tuple[int, int, int, QRect] | None = None  # versions of A and B, ping on top, place
        self.setMouseTracking(True)
        b.installEventFilter(self)
        b.is_covered = self.take
        self.hide()

    def show_records(self, titles: tuple[str, str], *, by_ping: bool) -> None:
        """Name both records, and say whether their rows are paired by ping."""
        self._titles, self._by_ping = titles, by_ping
        self._difference_of = None
        self.update()

    def arrange(self, arrangement: Arrangement) -> None:
        """Draw record A in another way; `Arrangement.BESIDE` leaves it to its own view."""
        self._arrangement = arrangement
        self._lay()

    def leave(self) -> None:
        """Draw nothing, for there is no record A."""
        self._held = False
        self.arrange(Arrangement.BESIDE)

    def hold(self, held: bool) -> None:
        """Draw A in the place of B while a key is held."""
        if held != self._held:
            self._held = held
            self.update()

    @property
    def split(self) -> int:
        """Place of the split line, in pixels from the left of the view."""
        plot = self._b.plot_area
        return plot.left() + round(self._split * plot.width())

    def covers(self, place: QPoint) -> bool:
        """Whether record A is drawn at a place."""
        plot = self._b.plot_area
        if not plot.contains(place):
            return False
        return self._held or (self._arrangement is Arrangement.WIPED and place.x() < self.split)

    def follow(self) -> None:
        """Draw anew if record A has changed; the picture of B draws the overlay with itself."""
        if self.isVisible() and self._followed != self._a.image.version:
            self.update()

    def place_of_a(self) -> QRectF:
        """Where record A lies in the view of B, its range and its pings on screen."""
        plot, (left, right) = self._b.plot_area, self._a.projection.extent
        x = self._b.projection.across(np.array([left, right])) * plot.width() + plot.left()
        y = self._ends(len(self._a.record.shown(self._a.top)) / self._a.rows_a_ping)
        return QRectF(x[0], min(y), x[1] - x[0], abs(y[1] - y[0]))

    def _ends(self, pings: float) -> tuple[float, float]:
        """Heights in the view of B at which some of its newest pings begin and end."""
        plot, projection = self._b.plot_area, self._b.projection
        ends = projection.down(projection.newest - np.array([0.0, pings])) * plot.height() + plot.top()
        return float(ends[0]), float(ends[1])

    @guard_override(False)
    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Keep the size of record B, and move the split line by its keys."""
        if event.type() is QEvent.Type.Resize:
            self._lay()
        if not isinstance(event, QKeyEvent) or event.type() is not QEvent.Type.KeyPress:
            return False
        wipes = event.key() in WIPES and modifiers_of(event) == Qt.KeyboardModifier.AltModifier
        if not wipes or self._arrangement is not Arrangement.WIPED:
            return False
        self._move_split(self._split + WIPES[event.key()])
        return True

    def take(self, place: QPoint) -> bool:
        """Move the cursor of the record that is drawn at a place; return whether that is A."""
        if not self.isVisible():
            return False
        over = self.covers(place)
        if over:
            self._b.hovered.emit(None)
        self._a.hovered.emit(self._a.mark_at(place) if over else None)
        return over

    def _move_split(self, share: float) -> None:
        self._split = min(max(share, 0.0), 1.0)
        self.update()

    def _lay(self) -> None:
        """Cover record B, and compute the picture of A for its place, unless A has a view of its own."""
        over = self._arrangement is not Arrangement.BESIDE
        self.setVisible(over)
        self._a.lie_over(self._b if over else None, by_ping=self._by_ping)
        if over:
            self.resize(self._b.size())
            self.update()

    def paint(self, painter: QPainter) -> None:
        """Draw record A, or the difference, over the record, and say what is drawn."""
        plot = self._b.plot_area
        self._a.follow()
        self._followed = self._a.image.version
        if self._held:
            self._draw_a(painter, plot)
            self._caption(painter, plot, f"A  {self._titles[0]}")
        elif self._arrangement is Arrangement.WIPED:
            self._draw_a(painter, QRect(plot.left(), plot.top(), self.split - plot.left(), plot.height()))
            self._draw_split(painter, plot)
        elif self._arrangement is Arrangement.DIFFERENCE:
            self._draw_difference(painter, plot)
        else:
            self._caption(painter, plot, "B  hold X for A")

    def _draw_a(self, painter: QPainter, covered: QRect) -> None:
        painter.save()
        painter.setClipRect(covered)
        painter.fillRect(covered, QColor(EMPTY))
        painter.setClipRect(self.place_of_a().toAlignedRect().intersected(covered))
        self._a.draw_over(painter)
        painter.restore()

    def _draw_rows(self, painter: QPainter, pixels: NDArray[np.uint32]) -> None:
        """Draw rows, newest first, over those of B."""
        if not pixels.size:
            return
        plot, (newest, oldest) = self._b.plot_area, self._ends(len(pixels))
        upwards = oldest < newest
        rows, width = pixels.shape
        shown = np.ascontiguousarray(pixels[::-1]) if upwards else pixels
        image = QImage(shown.data, width, rows, 4 * width, QImage.Format.Format_RGB32)
        place = QRectF(plot.left(), min(newest, oldest), plot.width(), abs(oldest - newest))
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, rows > place.height())
        painter.drawImage(place, image, QRectF(0, 0, width, rows))

    def _draw_split(self, painter: QPainter, plot: QRect) -> None:
        x = self.split
        painter.setPen(QPen(QColor(ACCENT_IN_WATER), 2))
        painter.drawLine(x, plot.top(), x, plot.bottom())
        painter.setBrush(QColor(ACCENT_IN_WATER))
        painter.drawEllipse(QPoint(x, plot.center().y()), GRIP, GRIP)
        left, right = QRect(plot), QRect(plot)
        left.setRight(x - 8)
        right.setLeft(x + 2)
        self._caption(painter, left, f"A  {self._titles[0]}", to_the_right=True)
        self._caption(painter, right, f"B  {self._titles[1]}")

    def _draw_difference(self, painter: QPainter, plot: QRect) -> None:
        wanted = (self._a.image.version, self._b.image.version, self._b.top, QRect(plot))
        if self.difference is None or wanted != self._difference_of:
            self._difference_of = wanted
            self.difference = draw_difference(self._decibels(), colour_table(two_sided_palette()), EMPTY)
        painter.save()
        painter.setClipRect(plot)
        painter.fillRect(plot, QColor(EMPTY))
        painter.setClipRect(self.place_of_a().toAlignedRect().intersected(plot))
        self._draw_rows(painter, self.difference.pixels)
        painter.restore()
        self._draw_scale(painter, plot, self.difference.span)

    def _decibels(self) -> Singles:
        """Level of B over A in the display columns of B."""
        b = self._b.shown_columns()
        rows = ((np.arange(len(b[1])) + 0.5) * self._a.rows_a_ping).astype(np.int64)
        return decibels_between(self._a.shown_columns(), b, rows)

    def _draw_scale(self, painter: QPainter, plot: QRect, span: float) -> None:
        """Draw the palette with its ends in dB."""
        wide = min(160, plot.width() // 2)
        bar = QRect(plot.right() - wide - 56, plot.top() + 7, wide, 8)
        draw_veil(painter, QRect(bar.left() - 56, plot.top(), wide + 112, 40))
        colours = QLinearGradient(bar.left(), 0, bar.right(), 0)
        for at, colour in ((0.0, MARK), (0.5, GROUND), (1.0, ACCENT)):
            colours.setColorAt(at, QColor(colour))
        painter.fillRect(bar, colours)
        painter.setPen(QColor(TEXT))
        centre = Qt.AlignmentFlag.AlignCenter
        painter.drawText(QRect(bar.left() - 56, bar.top() - 5, 52, HIGH), centre, f"−{span:g} dB")
        painter.drawText(QRect(bar.right() + 4, bar.top() - 5, 52, HIGH), centre, f"+{span:g} dB")
        painter.drawText(QRect(bar.left() - 40, bar.bottom() + 4, wide + 80, HIGH), centre, "level of B over A")

    def _caption(self, painter: QPainter, room: QRect, words: str, *, to_the_right: bool = False) -> None:
        """Write the letter and the title of a record at the lower edge of its room."""
        text = painter.fontMetrics().elidedText(words, Qt.TextElideMode.ElideRight, room.width() - 16)
        wide = painter.fontMetrics().horizontalAdvance(text) + 12
        if room.width() < 24:
            return
        left = room.right() - wide - 2 if to_the_right else room.left() + 4
        place = QRect(left, room.bottom() - HIGH - 4, wide, HIGH)
        draw_veil(painter, place)
        painter.setPen(QColor(TEXT))
        painter.drawText(place, Qt.AlignmentFlag.AlignCenter, text)

    def _on_split(self, place: QPoint) -> bool:
        plot = self._b.plot_area
        inside = plot.top() <= place.y() <= plot.bottom()
        return self._arrangement is Arrangement.WIPED and abs(place.x() - self.split) <= GRIP and inside

    def _pass_on(self, event: QMouseEvent) -> None:
        """Leave the mouse to record B, unless it is over A: a pixel of A is not one of B."""
        if self.covers(event.position().toPoint()):
            event.accept()
        else:
            event.ignore()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Take hold of the split line."""
        self._dragged = event.button() is Qt.MouseButton.LeftButton and self._on_split(event.position().toPoint())
        if not self._dragged:
            self._pass_on(event)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Drag the split line, or point at what is under the mouse."""
        place = event.position().toPoint()
        if self._dragged:
            plot = self._b.plot_area
            self._move_split((place.x() - plot.left()) / max(plot.width(), 1))
            return
        if self._on_split(place):
            self.setCursor(Qt.CursorShape.SplitHCursor)
        else:
            self.unsetCursor()
        self.take(place)
        self._pass_on(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Let go of the split line, or signal a click into a recording."""
        place = event.position().toPoint()
        if self._dragged:
            self._dragged = False
            return
        clicks = event.button() is Qt.MouseButton.LeftButton and not self._by_ping and self.covers(place)
        if clicks and (mark := self._a.mark_at(place)) is not None:
            self._a.clicked.emit(mark)
        self._pass_on(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Turn the wheel over record A, or leave it to record B."""
        if self.covers(event.position().toPoint()):
            self._a.wheelEvent(event)
        else:
            event.ignore()


class DifferencePicture(NamedTuple):
    """Ratio of two records."""

    pixels: NDArray[np.uint32]  # (n, width) colours 0xffRRGGBB, newest ping first
    span: float  # decibels at the ends of the palette


def decibels_between(a: Columns, b: Columns, rows: Integers) -> Singles:
    """Level of B over A, pixel by pixel."""
    known = (rows >= 0) & (rows < len(a[1])) & b[1]
    known[known] = a[1][rows[known]]
    one, other = a[0][rows[known]], b[0][known]
    ratio = (np.square(other) + np.float32(FLOOR)) / (np.square(one) + np.float32(FLOOR))
    level = np.float32(10.0) * np.log10(ratio)
    level[(one < 0.0) | (other < 0.0)] = np.nan
    out = np.full(b[0].shape, np.nan, dtype=np.float32)
    out[known] = level
    return out


def draw_difference(decibels: Singles, table: NDArray[np.uint32], empty: int) -> DifferencePicture:
    """Colour decibels, with ends that hold all but a few pixels."""
    unknown = np.isnan(decibels)
    sizes = np.abs(decibels.ravel()[::SAMPLED])
    sizes = sizes[np.isfinite(sizes)]
    large = float(np.quantile(sizes, 1.0 - CLIPPED)) if sizes.size else 0.0
    span = next((span for span in SPANS if span >= large), SPANS[-1])
    pixels = colour_rows(np.where(unknown, np.float32(0.0), decibels), -span, span, table)
    pixels[unknown] = empty
    return DifferencePicture(np.ascontiguousarray(pixels), span)
