"""Paint over and beside a record: rulers, range lines, marks, contacts, progress bar, scroll handle."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPoint, QPointF, QRect, QRectF, QSize, Qt
from PySide6.QtGui import QBrush, QColor, QImage, QPainter, QPen, QPolygonF

from insonify.arrays import Floats, Integers, Singles
from insonify.display.range_axis import NAMES
from insonify_viewer.record.projection import Projection
from insonify_viewer.state.inspection import Mark
from insonify_viewer.widgets.painting import LIT, draw_lit, draw_pin, draw_veil, image_of, round_steps
from insonify_viewer.widgets.theme import ACCENT, EDGE, GROUND, HALO, MARK_IN_WATER, QUIET, RAISED, TEXT
from insonify_viewer.work.waiting import Waiting

BAR = 5  # px, thickness of the bar that shows which part of the range is seen
LEAST_BAR = 24.0  # px
MOST_POINTS = 200  # of the bottom line
LINE = QColor(255, 255, 255, 70)  # of equal range
BED = "#ffb000"  # distinct from the palettes' middle tones
CONTACT = "#7dff5a"
MOST_OPAQUE = 190  # of 255, of an error
THIN, HIGH = 4, 24  # px, of the bar and of its text
WIDTH, HEIGHT, ROUND = 20.0, 26.0, 4.0  # px
APART = 14  # px, between a measured line and what it measures
LABEL = 92.0  # px, of the ping beside a held handle


@dataclass(eq=False)
class BinErrors:
    """Estimated errors of the bins of successive pings."""

    pings: Integers  # (n,) numbers, the newest first
    shares: Singles  # (n, 2 bins) of the mean echoes, from far port over nadir to far starboard; 0 where not known
    altitude: Floats  # (n,) in metres
    full: float  # share that is drawn in full colour
    _drawn: tuple[object, QImage] | None = None  # the picture, and what it is of

    def picture(self, projection: Projection, width: int) -> QImage:
        """Draw the errors in the columns of a plot, the more opaque the greater they are; scrolling changes nothing."""
        of = projection.axis, projection.side, projection.shown, width
        if self._drawn is None or self._drawn[0] != of:
            columns = projection.columns(self.shares, self.altitude, width)
            pixels = np.empty((*columns.shape, 4), np.uint8)
            pixels[..., :3] = np.array(QColor(LIT).toTuple())[:3]
            pixels[..., 3] = np.rint(MOST_OPAQUE * np.clip(columns / np.float32(self.full), 0.0, 1.0))
            self._drawn = of, image_of(pixels)
        return self._drawn[1]


def draw_errors(painter: QPainter, plot: QRect, projection: Projection, errors: BinErrors) -> None:
    """Lay the errors of bins over a record."""
    ends = projection.down(errors.pings[[0, -1]] - np.array([0.0, 1.0])) * plot.height() + plot.top()
    image = errors.picture(projection, plot.width())
    image = image if ends[1] > ends[0] else image.flipped(Qt.Orientation.Vertical)
    painter.drawImage(QRectF(plot.left(), min(ends), plot.width(), abs(ends[1] - ends[0])), image)


def draw_range_lines(painter: QPainter, plot: QRect, projection: Projection, text: float) -> None:
    """Draw lines of equal range at the ticks of the ruler."""
    painter.setPen(LINE)
    for _, x in range_ticks(plot, projection, text):
        painter.drawLine(x, plot.top(), x, plot.bottom())


def draw_bottom_line(painter: QPainter, plot: QRect, projection: Projection) -> None:
    """Draw the slant range of the bed beneath the sonar on both sides."""
    upper, lower = projection.ages
    count = min(plot.height(), MOST_POINTS)
    apart = plot.height() / count
    ages = np.linspace(upper, lower, count, endpoint=False)
    pings = (projection.newest - np.floor(ages)).astype(np.int64)
    altitude = projection.altitude_of(np.maximum(pings, 0))
    known = np.flatnonzero((altitude > 0.0) & (pings >= 0))
    distance = projection.axis.distance_of(altitude / projection.axis.bin_length * (1.0 + 1e-12), altitude)
    painter.setPen(QPen(QColor(BED), 1.2))
    for sign in (-1.0, 1.0):
        x = plot.left() + projection.across(sign * distance) * plot.width()
        inside = known[(x[known] >= plot.left()) & (x[known] <= plot.right())]
        for run in np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1):
            painter.drawPolyline(QPolygonF([QPointF(x[k], plot.top() + (k + 0.5) * apart) for k in run]))


def draw_cross(painter: QPainter, place: QPoint) -> None:
    """Draw a cross about the point under the mouse."""
    for colour, width in ((HALO, 4), (MARK_IN_WATER, 2)):
        painter.setPen(QPen(QColor(colour), width))
        for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            painter.drawLine(place + QPoint(5 * dx, 5 * dy), place + QPoint(14 * dx, 14 * dy))


def draw_measured(painter: QPainter, plot: QRect, ends: tuple[QPoint, QPoint], words: str) -> None:
    """Draw a measured line with its length in words, inside the plot."""
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    for colour, width in ((HALO, 4.0), (MARK_IN_WATER, 2.0)):
        painter.setPen(QPen(QColor(colour), width))
        painter.drawLine(*ends)
        for end in ends:
            painter.drawEllipse(QPointF(end), 3.0, 3.0)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
    wrapped = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
    size = painter.fontMetrics().boundingRect(QRect(0, 0, plot.width() - 20, plot.height()), wrapped, words)
    box = _place_beside(QRect(*ends).normalized(), QSize(size.width() + 14, size.height() + 8), plot)
    painter.setPen(QColor(EDGE))
    painter.setBrush(QColor(RAISED))
    painter.drawRoundedRect(box, 4.0, 4.0)
    painter.setPen(QColor(TEXT))
    painter.drawText(box.adjusted(6, 4, -6, -4), wrapped, words)


def _place_beside(line: QRect, size: QSize, plot: QRect) -> QRect:
    """Place a box in a plot beside what a line spans: right, left, below or above, where there is room."""
    room = plot.adjusted(2, 2, -2, -2)
    across, down = line.width() // 2 + size.width() // 2 + APART, line.height() // 2 + size.height() // 2 + APART
    box = QRect(QPoint(), size)
    for x, y in ((across, 0), (-across, 0), (0, down), (0, -down)):
        box.moveCenter(line.center() + QPoint(x, y))
        # The box may be moved along the line, within the plot.
        box.moveLeft(box.left() if x else max(min(box.left(), room.right() + 1 - box.width()), room.left()))
        box.moveTop(max(min(box.top(), room.bottom() + 1 - box.height()), room.top()) if x else box.top())
        if room.contains(box):
            return box
    box.moveTop(max(min(box.top(), room.bottom() + 1 - box.height()), room.top()))
    return box


def draw_contacts(painter: QPainter, plot: QRect, contacts: Iterable[tuple[QPoint, str, bool]]) -> None:
    """Draw contacts as corners about their places, with their names; a chosen one is drawn stronger."""
    painter.setBrush(Qt.BrushStyle.NoBrush)
    for place, name, chosen in contacts:
        if not plot.contains(place):
            continue
        for colour, width in ((HALO, 4.0), (CONTACT, 2.5 if chosen else 1.5)):
            painter.setPen(QPen(QColor(colour), width))
            for dx, dy in ((-1, -1), (1, -1), (-1, 1), (1, 1)):
                corner = place + QPoint(9 * dx, 9 * dy)
                painter.drawPolyline([corner - QPoint(5 * dx, 0), corner, corner - QPoint(0, 5 * dy)])
        right = place.x() + 14 + painter.fontMetrics().horizontalAdvance(name) <= plot.right()
        x = place.x() + 14 if right else place.x() - 14 - painter.fontMetrics().horizontalAdvance(name)
        box = painter.fontMetrics().boundingRect(name).translated(x, place.y() + 4)
        draw_veil(painter, box.adjusted(-3, -1, 3, 1))
        painter.setPen(QColor(CONTACT))
        painter.drawText(x, place.y() + 4, name)


def draw_range_bar(painter: QPainter, plot: QRect, projection: Projection) -> None:
    """Draw which part of the range, and which of the stored pings, a zoomed record shows."""
    zoom = projection.zoom
    if zoom.whole:
        return
    painter.setPen(Qt.PenStyle.NoPen)
    for horizontal, first, last in ((True, zoom.left, zoom.right), (False, zoom.upper, zoom.lower)):
        if (first, last) == (0.0, 1.0):
            continue
        length = plot.width() if horizontal else plot.height()
        long = max((last - first) * length, LEAST_BAR)
        start = first / max(1.0 - last + first, 1e-9) * (length - long)
        for colour, at, size in ((QColor(RAISED), 0.0, float(length)), (QColor(QUIET), start, long)):
            painter.setBrush(colour)
            if horizontal:
                painter.drawRect(QRectF(plot.left() + at, plot.bottom() + 1 - BAR, size, BAR))
            else:
                painter.drawRect(QRectF(plot.right() + 1 - BAR, plot.top() + at, BAR, size))


def draw_waiting(painter: QPainter, plot: QRect, waiting: Waiting) -> None:
    """Draw a bar along the upper edge of a plot; a bar of unknown length is hatched."""
    strip = QRect(plot.left(), plot.top(), plot.width(), THIN + HIGH)
    draw_veil(painter, strip)
    bar = QRect(strip.left(), strip.top(), strip.width(), THIN)
    painter.fillRect(bar, QColor(EDGE))
    if waiting.share is None:
        painter.fillRect(bar, QBrush(QColor(ACCENT), Qt.BrushStyle.BDiagPattern))
    else:
        bar.setWidth(round(min(max(waiting.share, 0.0), 1.0) * bar.width()))
        painter.fillRect(bar, QColor(ACCENT))
    painter.setPen(QColor(TEXT))
    text = strip.adjusted(8, THIN, -8, 0)
    words = painter.fontMetrics().elidedText(waiting.what, Qt.TextElideMode.ElideRight, text.width())
    painter.drawText(text, Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft, words)


def draw_word(painter: QPainter, plot: QRect, word: str) -> None:
    """Draw a word in the upper left corner of a plot."""
    box = painter.fontMetrics().boundingRect(word).adjusted(-6, -2, 6, 2)
    box.moveTopLeft(plot.topLeft() + QPoint(4, 4))
    draw_veil(painter, box)
    painter.setPen(QColor(QUIET))
    painter.drawText(box, Qt.AlignmentFlag.AlignCenter, word)


def draw_range_ruler(
    painter: QPainter, plot: QRect, projection: Projection, scale: str, text: float, taken: int
) -> None:
    """Draw metres of range from nadir to both sides; the first pixels of the line of their name are taken."""
    base = plot.bottom() + 1
    for value, x in range_ticks(plot, projection, text):
        painter.setPen(QColor(EDGE))
        painter.drawLine(x, base, x, base + 5)
        painter.setPen(QColor(QUIET))
        place = _lines(x - round(40 * text), base + 6, round(80 * text), text)
        painter.drawText(place, Qt.AlignmentFlag.AlignHCenter, f"{abs(value):g}")
    painter.setPen(QColor(QUIET))
    beyond = round(24 * text)  # the margins hold what is longer than the record is wide
    begin, end = plot.left() + (taken or -beyond), plot.right() + beyond
    name = f"{NAMES[projection.axis.kind]} (m)"
    whole = f"{name}  ·  {scale}"
    words = whole if painter.fontMetrics().horizontalAdvance(whole) <= end - begin else name
    left = max(plot.center().x() - painter.fontMetrics().horizontalAdvance(words) // 2, begin)
    painter.drawText(_lines(left, base + round(20 * text), end - left, text), Qt.AlignmentFlag.AlignLeft, words)
    painter.setPen(QColor(TEXT))
    line = _lines(plot.left(), plot.top() - round(20 * text), plot.width(), text)
    first, last = projection.shown
    roomy = painter.fontMetrics().horizontalAdvance("port  starboard") <= line.width()
    if first < 0.0:
        painter.drawText(line, Qt.AlignmentFlag.AlignLeft, "port" if roomy else "P")
    if last > 0.0:
        painter.drawText(line, Qt.AlignmentFlag.AlignRight, "starboard" if roomy else "S")


def range_ticks(plot: QRect, projection: Projection, text: float) -> list[tuple[float, int]]:
    """Round distances from nadir within a plot, negative to port, with their places in pixels."""
    values = round_steps(*projection.shown, max(int(plot.width() / (65 * text)), 1))
    return [(value, plot.left() + int(float(projection.across(np.array(value))) * plot.width())) for value in values]


def draw_ping_ruler(painter: QPainter, area: QRect, projection: Projection, step: float, text: float) -> None:
    """Draw ping numbers, each with the metres towed."""
    right, width = area.right() + 1, area.width() - 9
    newest, oldest = sorted(projection.ages)
    steps = round_steps(0.0, oldest - newest, max(int(area.height() / (70 * text)), 1))
    apart = max(int(steps[1]), 1) if len(steps) > 1 else max(int(oldest - newest), 1)
    first, last = math.floor(projection.newest - oldest) + 1, math.floor(projection.newest - newest)
    for ping in range(max(first, 0) // apart * apart, last + 1, apart):
        y = area.top() + int(float(projection.down(np.array(ping - 0.5))) * area.height())
        if not area.top() + 8 <= y <= area.bottom():
            continue
        painter.setPen(QColor(EDGE))
        painter.drawLine(right - 5, y, right - 1, y)
        painter.setPen(QColor(TEXT))
        painter.drawText(_lines(area.left(), y - round(13 * text), width, text), Qt.AlignmentFlag.AlignRight, f"{ping}")
        towed = _lines(area.left(), y, width, text)
        if towed.bottom() <= area.bottom() + 6:  # lower, the range ruler begins
            painter.setPen(QColor(QUIET))
            painter.drawText(towed, Qt.AlignmentFlag.AlignRight, write_towed(ping * step, apart * step))
    painter.setPen(QColor(QUIET))
    place = _lines(area.left(), area.top() - round(20 * text), width, text)
    painter.drawText(place, Qt.AlignmentFlag.AlignRight, "ping")


def write_towed(metres: float, apart: float) -> str:
    """Metres towed, to tenths unless the numbers are nearer to each other."""
    return f"{round(metres, 1 if apart >= 0.2 else 3):g} m"


def _lines(left: int, top: int, width: int, text: float) -> QRect:
    """Room for one line of text by a factor larger than usual."""
    return QRect(left, top, width, round(16 * text))


@dataclass
class RecordMarks:
    """What is marked in a record, and how it is painted."""

    cross: Mark | None = None  # point under the mouse
    pin: Mark | None = None  # pinned pixel
    lit: tuple[Mark, ...] = ()  # pixels that hear a picked place
    contacts: Sequence[tuple[Mark, str, bool]] = ()  # contacts with their names; True for the chosen one
    line: tuple[Mark, Mark, str] | None = None  # (Mark, Mark, str) ends of a measured line, and its length in words

    @property
    def pointed(self) -> Mark | None:
        """The pinned pixel, else the point under the mouse."""
        return self.pin or self.cross

    def draw(self, painter: QPainter, plot: QRect, place_of: Callable[[Mark], QPoint]) -> None:
        """Paint all marks inside a plot; ``place_of`` finds the place of one."""
        draw_lit(painter, (place for place in map(place_of, self.lit) if plot.contains(place)))
        draw_contacts(painter, plot, ((place_of(mark), name, chosen) for mark, name, chosen in self.contacts))
        for mark, draw in ((self.pin, draw_pin), (self.cross, draw_cross)):
            if mark is not None and plot.contains(place_of(mark)):
                draw(painter, place_of(mark))
        if self.line is not None:
            near, far, words = self.line
            draw_measured(painter, plot, (place_of(near), place_of(far)), words)


class ScrubHandle:
    """Strip with all pings of a tow, and the handle that scrolls; the last ping is on top or below as in the record."""

    def __init__(self) -> None:
        self.last = 1
        self.held = False
        self.newest_on_top = True
        self._rail = QRectF()

    def lay(self, left: float, top: float, height: float) -> None:
        """Place the rail."""
        self._rail = QRectF(left, top, WIDTH, height)

    def contains(self, place: QPointF) -> bool:
        """Whether a place lies on the rail, or beside it within a few pixels."""
        return self._rail.adjusted(-4.0, 0.0, 4.0, 0.0).contains(place)

    def ping_at(self, place: QPointF) -> int:
        """Ping at a height of the rail."""
        share = (place.y() - self._rail.top() - HEIGHT / 2.0) / max(self._rail.height() - HEIGHT, 1.0)
        share = min(max(share, 0.0), 1.0)
        return round((1.0 - share if self.newest_on_top else share) * self.last)

    def place_of(self, ping: int) -> QPointF:
        """Middle of the handle for a ping on top of the record."""
        share = min(max(ping / max(self.last, 1), 0.0), 1.0)
        share = 1.0 - share if self.newest_on_top else share
        middle = self._rail.top() + HEIGHT / 2.0 + share * (self._rail.height() - HEIGHT)
        return QPointF(self._rail.center().x(), middle)

    @property
    def room(self) -> int:
        """Height in px of the strip from the first ping to the last."""
        return max(round(self._rail.height() - HEIGHT), 1)

    def draw(self, painter: QPainter, ping: int, overview: QImage, shown: tuple[float, float]) -> None:
        """Draw the strip, the stretch between two pings that is shown, and the handle, with its ping while held."""
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(RAISED))
        painter.drawRoundedRect(self._rail, ROUND, ROUND)
        strip = self._rail.adjusted(0.0, HEIGHT / 2.0, 0.0, -HEIGHT / 2.0)
        painter.drawImage(strip, overview.flipped(Qt.Orientation.Vertical) if self.newest_on_top else overview)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        upper, lower = sorted(self.place_of(round(end)).y() for end in shown)
        painter.setPen(QPen(QColor(ACCENT), 1.5))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawRect(QRectF(strip.left(), upper, strip.width(), max(lower - upper, 2.0)))
        painter.setPen(Qt.PenStyle.NoPen)
        middle = self.place_of(ping)
        handle = QRectF(self._rail.left() + 4.0, middle.y() - HEIGHT / 2.0, WIDTH - 8.0, HEIGHT)
        painter.setBrush(QColor(ACCENT if self.held else QUIET))
        painter.drawRoundedRect(handle, ROUND, ROUND)
        painter.setPen(QColor(GROUND))
        for step in (-3.0, 0.0, 3.0):
            y = middle.y() + step
            painter.drawLine(QPointF(handle.left() + 3.0, y), QPointF(handle.right() - 3.0, y))
        if self.held:
            self._draw_ping(painter, handle, ping)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)

    def _draw_ping(self, painter: QPainter, handle: QRectF, ping: int) -> None:
        box = QRectF(handle.left() - LABEL - 6.0, handle.top() + 3.0, LABEL, HEIGHT - 6.0)
        painter.setPen(QColor(EDGE))
        painter.setBrush(QColor(RAISED))
        painter.drawRoundedRect(box, ROUND, ROUND)
        painter.setPen(QColor(TEXT))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, f"ping {ping}")
