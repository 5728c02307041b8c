"""Pictures of a record: a ring of coloured rows, each coloured once, and all pings beside the scroll handle."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QBuffer, QByteArray, QPoint, QRect, QRectF
from PySide6.QtGui import QColor, QImage, QImageWriter, QPainter

from insonify.arrays import Floats, Integers, Singles
from insonify_viewer.record.projection import Projection
from insonify_viewer.record.record import Record
from insonify_viewer.record.tone_map import ToneMap
from insonify_viewer.widgets.painting import column_means, dimmed

EMPTY = 0xFF0B1118
SNAPSHOT = 128  # px, side of a picture about a place
COLUMNS = 20  # from far port to far starboard
GROWTH = 1024  # pings for which there is room beyond the last one


class Layout(NamedTuple):
    """What the picture of a row depends on, besides the row."""

    projection: Projection
    tone_map: ToneMap
    width: int  # in columns

    def fits(self, projection: Projection, width: int) -> bool:
        """Whether a projection on a width has the same columns."""
        one, other = self.projection, projection
        same = (one.axis, one.side, one.zoom, self.width) == (other.axis, other.side, other.zoom, width)
        return same and np.array_equal(np.asarray(one.factors), np.asarray(other.factors))

    def draw(self, amplitude: Singles, altitude: Floats, reach: Floats | None) -> DrawnRows:
        """Average and colour rows, on any thread; `WaterfallView.show_rows` explains the parameters."""
        projection = self.projection
        if projection.factors is not None:
            amplitude = amplitude * projection.factors
        means = projection.columns(amplitude, np.nan_to_num(altitude), self.width)
        if reach is not None and len(means):
            means = blur_along_track(means, reach[projection.bins_of_columns(projection.newest, self.width)])
        return DrawnRows(self, means, _coloured(means, projection, self.tone_map))


class DrawnRows(NamedTuple):
    """Rows of a record as they are shown."""

    layout: Layout
    means: Singles  # (n, width) amplitudes in display columns
    colours: NDArray[np.uint32]  # (n, width) as 0xffRRGGBB


class RecordImage:
    """Display columns and colours of the rows of a record."""

    def __init__(self) -> None:
        self.version = 0
        self.oldest = -1
        self.layout: Layout | None = None

    def fit(self, record: Record, projection: Projection, tone_map: ToneMap, width: int) -> None:
        """Compute the display columns and the colours of every row for a width."""
        self._record, self._downwards = record, projection.newest_on_top
        self.layout = Layout(projection, tone_map, width)
        self._columns = np.zeros((record.pings, width), dtype=np.float32)
        held = np.flatnonzero(record.ping >= 0)
        if held.size:
            self._columns[held] = self._averaged(held, projection)
        self.pixels = np.full((record.pings, width), EMPTY, dtype=np.uint32)
        # The image shares the memory of the array; both live as long as this object.
        self._image = QImage(self.pixels.data, width, record.pings, 4 * width, QImage.Format.Format_RGB32)
        self.paint(np.arange(record.pings), projection, tone_map)

    def put(
        self,
        rows: Integers,
        projection: Projection,
        tone_map: ToneMap,
        reach: Floats | None,
        drawn: DrawnRows | None = None,
    ) -> None:
        """Take over rows that the record has just received; `WaterfallView.show_rows` explains the parameters."""
        self.layout = Layout(projection, tone_map, self._columns.shape[1])
        if drawn is None or not drawn.layout.fits(projection, self.layout.width):
            drawn = self.layout.draw(self._record.amplitude[rows], self._record.altitude[rows], reach)
        elif drawn.layout.tone_map is not tone_map:
            drawn = drawn._replace(colours=_coloured(drawn.means, projection, tone_map))
        self._columns[rows] = drawn.means
        self._put_colours(rows, drawn.colours, projection)

    def paint(self, rows: Integers, projection: Projection, tone_map: ToneMap) -> None:
        """Colour rows that hold a ping anew; blank rows of pings outside the picture."""
        rows = rows[self._record.ping[rows] >= 0]
        self._put_colours(rows, _coloured(self._columns[rows], projection, tone_map), projection)

    def _put_colours(self, rows: Integers, painted: NDArray[np.uint32], projection: Projection) -> None:
        """Show rows by their colours, which are written to; blank or dim some of them."""
        record = self._record
        stale = record.stamp[rows] < self.oldest
        painted[stale] = dimmed(painted[stale])
        age = projection.newest - record.ping[rows]
        painted[(age < 0) | (age >= record.pings)] = EMPTY
        self.pixels[self._places(rows)] = painted
        self.version += 1

    def blank(self, rows: Integers) -> None:
        """Blank rows."""
        self.pixels[self._places(rows)] = EMPTY

    def columns(self, rows: Integers) -> Singles:
        """Amplitudes of some rows in display columns; negative beyond the last bin."""
        return np.asarray(self._columns[rows])

    def draw(self, painter: QPainter, plot: QRect, projection: Projection) -> None:
        """Draw the part that the projection shows, in the two pieces of the ring."""
        pings, width = self.pixels.shape
        top, bottom = sorted(projection.ages)
        newest = pings - 1 - projection.newest % pings  # row of the newest ping
        first = (newest + top) % pings if self._downwards else (pings - newest - bottom) % pings
        shown = bottom - top
        above = min(shown, pings - first)
        seam = plot.top() + round(above / shown * plot.height())
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform, shown > plot.height())
        upper = QRectF(plot.left(), plot.top(), plot.width(), seam - plot.top())
        painter.drawImage(upper, self._image, QRectF(0.0, first, width, above))
        if shown > above:
            lower = QRectF(plot.left(), seam, plot.width(), plot.bottom() + 1 - seam)
            painter.drawImage(lower, self._image, QRectF(0.0, 0.0, width, shown - above))

    def snapshot(self, plot: QRect, projection: Projection, place: QPoint) -> bytes:
        """Draw the surroundings of a place of the plot as PNG."""
        picture = QImage(SNAPSHOT, SNAPSHOT, QImage.Format.Format_RGB32)
        picture.fill(QColor.fromRgb(EMPTY))
        with QPainter(picture) as painter:
            painter.translate(QPoint(SNAPSHOT // 2, SNAPSHOT // 2) - place)
            self.draw(painter, plot, projection)
        buffer = QBuffer()
        buffer.open(QBuffer.OpenModeFlag.WriteOnly)
        QImageWriter(buffer, QByteArray(b"PNG")).write(picture)
        return bytes(buffer.data().data())

    def _averaged(self, rows: Integers, projection: Projection) -> Singles:
        """Display columns of rows of the record."""
        record, width = self._record, self._columns.shape[1]
        altitude = np.nan_to_num(record.altitude[rows])
        if projection.factors is None:
            return projection.columns(record.amplitude, altitude, width, rows)
        return projection.columns(record.amplitude[rows] * projection.factors, altitude, width)

    def _places(self, rows: Integers) -> Integers:
        """Rows of the picture that show rows of the record."""
        return rows if self._downwards else self._record.pings - 1 - rows


def _coloured(columns: Singles, projection: Projection, tone_map: ToneMap) -> NDArray[np.uint32]:
    """Colours of display columns, blank beyond the last bin."""
    painted = tone_map.colours(columns)
    if not projection.axis.shows_water:
        painted[columns < 0.0] = EMPTY
    return painted


class RecordOverview:
    """Amplitudes of every recorded ping in a few columns; a new edit of the scene begins it anew."""

    def __init__(self) -> None:
        self.columns = np.zeros((0, COLUMNS), dtype=np.float32)  # NaN for pings that were not recorded
        self._stamp = 0  # of the edit that is shown, 0 for a record that does not change
        self._drawn: tuple[int, int, ToneMap] | None = None  # height, last ping and colours of the picture
        self._pixels: NDArray[np.uint32] = np.zeros((1, COLUMNS), dtype=np.uint32)

    def put(self, record: Record, rows: Integers) -> None:
        """Take over rows that a record has just received."""
        stamp = int(record.stamp[rows].max(initial=-1))
        if stamp > self._stamp:
            self._stamp, self.columns[:] = stamp, np.nan
        if rows.size and stamp == self._stamp:
            self.fill(record.ping[rows], column_means(record.amplitude[rows], COLUMNS))

    def fill(self, pings: Integers, columns: Singles) -> None:
        """Take over the amplitudes of pings in `COLUMNS` columns."""
        if (beyond := int(pings.max(initial=-1)) + 1) > len(self.columns):
            self.columns = np.pad(
                self.columns, ((0, beyond + GROWTH - len(self.columns)), (0, 0)), constant_values=np.nan
            )
        self.columns[pings] = columns
        self._drawn = None

    def draw(self, height: int, last: int, tone_map: ToneMap) -> QImage:
        """Draw the pings up to the last one into rows of a picture, the first ping in the first row."""
        if self._drawn is None or self._drawn[:2] != (height, last) or self._drawn[2] is not tone_map:
            self._drawn = height, last, tone_map
            edges = np.arange(height) * (last + 1) // height
            known = np.pad(self.columns, ((0, max(last + 1 - len(self.columns), 0)), (0, 0)), constant_values=np.nan)
            there = np.isfinite(known[: last + 1])
            sums = np.add.reduceat(np.where(there, known[: last + 1], np.float32(0.0)), edges)
            count = np.add.reduceat(there.astype(np.float32), edges)
            self._pixels = np.full(sums.shape, EMPTY, dtype=np.uint32)
            rows = np.flatnonzero(count[:, 0])
            if rows.size:  # else the window opens before the kernels that colour are loaded
                means = np.asarray(sums[rows] / count[rows], dtype=np.float32)
                self._pixels[rows] = tone_map.colours(means)
        # The image shares the memory of the array.
        return QImage(self._pixels.data, COLUMNS, height, 4 * COLUMNS, QImage.Format.Format_RGB32)


def blur_along_track(columns: Singles, reach: Floats) -> Singles:
    """Average energy over the number of successive pings that the beam covers."""
    half = 0.5 * np.maximum(reach, 1.0)
    margin = int(half.max() + 0.5) + 1
    energy = np.square(np.pad(columns, ((margin, margin), (0, 0)), mode="edge"))
    total = np.zeros((len(energy) + 1, columns.shape[1]), dtype=np.float32)
    np.cumsum(energy, axis=0, out=total[1:])
    out = columns.copy()
    whole = np.floor(half + 0.5).astype(np.int64)
    part = (half + 0.5 - whole).astype(np.float32)
    ends = np.flatnonzero(np.diff(whole, prepend=-1, append=-1))
    # The columns of a run average over the same rows.
    for run in (slice(first, end) for first, end in pairwise(ends) if whole[first] > 0):
        far, near = margin + int(whole[run.start]), margin + 1 - int(whole[run.start])
        above, below = total[:, run], part[run]
        n = len(columns)
        summed = above[far : far + n] - above[near : near + n]
        summed += below * (energy[far : far + n, run] + energy[near - 1 : near - 1 + n, run])
        summed /= (2.0 * half[run]).astype(np.float32)
        out[:, run] = np.sqrt(np.maximum(summed, 0.0))  # rounding may make the difference of two sums negative
    return out
