"""The pings on screen: a ring of amplitudes in which a ping keeps its row for as long as it is held."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.int64]


class Record:
    """The last pings of a tow.

    Rows run against the ping numbers, so that the newest is the upper one; columns run from far port over nadir to
    far starboard, as the record is read.

    Parameters
    ----------
    pings : int
        Number of pings held.
    bins : int
        Range bins per side.

    Attributes
    ----------
    amplitude : (pings, 2 bins) float32
        Amplitudes relative to a level bed; 0 where nothing was heard or nothing is held.
    ping : (pings,) int64
        Number of the ping in each row, -1 for none.
    stamp : (pings,) int64
        What the row was traced for; see `missing`.
    """

    def __init__(self, pings: int, bins: int) -> None:
        self.amplitude = np.zeros((pings, 2 * bins), dtype=np.float32)
        self.ping = np.full(pings, -1, dtype=np.int64)
        self.stamp = np.full(pings, -1, dtype=np.int64)

    @property
    def pings(self) -> int:
        """Number of rows."""
        return len(self.ping)

    @property
    def bins(self) -> int:
        """Range bins per side."""
        return self.amplitude.shape[1] // 2

    def rows(self, pings: Rows) -> Rows:
        """Rows in which these pings are or would be held."""
        return self.pings - 1 - pings % self.pings

    def put(self, pings: Rows, amplitude: NDArray[np.float32], stamp: int) -> Rows:
        """Hold traced pings.

        Parameters
        ----------
        pings : (n,) int64
            Their numbers, each at most once.
        amplitude : (n, 2, bins) float32
            Port and starboard, near to far.
        stamp : int
            What they were traced for.

        Returns
        -------
        (n,) int64
            The rows they took.
        """
        rows = self.rows(pings)
        self.amplitude[rows, : self.bins] = amplitude[:, 0, ::-1]
        self.amplitude[rows, self.bins :] = amplitude[:, 1]
        self.ping[rows] = pings
        self.stamp[rows] = stamp
        return rows

    def shown(self, newest: int) -> Rows:
        """Numbers of the pings on screen when this one is on top, newest first; the tow starts at ping 0."""
        return np.arange(newest, max(newest - self.pings, -1), -1, dtype=np.int64)

    def missing(self, newest: int, stamp: int) -> Rows:
        """Pings that should be on screen and are not, or were traced for something older than ``stamp``."""
        pings = self.shown(newest)
        rows = self.rows(pings)
        return pings[(self.ping[rows] != pings) | (self.stamp[rows] < stamp)]

    def blank(self, newest: int) -> int:
        """How many pings should be on screen of which nothing is held, however old."""
        pings = self.shown(newest)
        return int((self.ping[self.rows(pings)] != pings).sum())

    def amplitude_at(self, ping: int, side: int, range_bin: int) -> float | None:
        """Amplitude of one bin (side 0 is port), None where the ping is not held."""
        row = int(self.rows(np.array([ping]))[0])
        if self.ping[row] != ping or not 0 <= range_bin < self.bins:
            return None
        column = self.bins - 1 - range_bin if side == 0 else self.bins + range_bin
        return float(self.amplitude[row, column])
