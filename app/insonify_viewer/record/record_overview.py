"""Narrow picture of every recorded ping, beside the scroll handle of a record."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QImage

from insonify_viewer.record.record import Record, Rows
from insonify_viewer.record.record_image import EMPTY
from insonify_viewer.record.tone_map import ToneMap
from insonify_viewer.widgets.painting import column_means

COLUMNS = 20  # from far port to far starboard
GROWTH = 1024  # pings for which there is room beyond the last one


class RecordOverview:
    """Amplitudes of every recorded ping in a few columns; a new edit of the scene begins it anew."""

    def __init__(self) -> None:
        self._columns = np.zeros((0, COLUMNS), dtype=np.float32)  # NaN for pings that were not recorded
        self._stamp = 0  # of the edit that is shown, 0 for a record that does not change
        self._drawn: tuple[int, int, ToneMap] | None = None  # height, last ping and colours of the picture
        self._pixels: NDArray[np.uint32] = np.zeros((1, COLUMNS), dtype=np.uint32)

    def put(self, record: Record, rows: Rows) -> None:
        """Take over rows that a record has just received."""
        stamp = int(record.stamp[rows].max(initial=-1))
        if stamp > self._stamp:
            self._stamp, self._columns[:] = stamp, np.nan
        if rows.size and stamp == self._stamp:
            self.fill(record.ping[rows], column_means(record.amplitude[rows], COLUMNS))

    def fill(self, pings: Rows, columns: NDArray[np.float32]) -> None:
        """Take over the amplitudes of pings in `COLUMNS` columns."""
        if (beyond := int(pings.max(initial=-1)) + 1) > len(self._columns):
            self._columns = np.pad(
                self._columns, ((0, beyond + GROWTH - len(self._columns)), (0, 0)), constant_values=np.nan
            )
        self._columns[pings] = columns
        self._drawn = None

    def draw(self, height: int, last: int, tone_map: ToneMap) -> QImage:
        """Draw the pings up to the last one into rows of a picture, the first ping in the first row."""
        if self._drawn is None or self._drawn[:2] != (height, last) or self._drawn[2] is not tone_map:
            self._drawn = height, last, tone_map
            edges = np.arange(height) * (last + 1) // height
            known = np.pad(self._columns, ((0, max(last + 1 - len(self._columns), 0)), (0, 0)), constant_values=np.nan)
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
