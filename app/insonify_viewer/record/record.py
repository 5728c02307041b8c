"""Ring buffer of the pings on screen; a ping keeps its row while it is stored."""

from dataclasses import dataclass

import numpy as np

from insonify.arrays import Floats, Integers, Singles
from insonify.scene import Scene
from insonify_viewer.work.ping_request import TracedPings

MAX_PINGS, MAX_CELLS = 2048, 2**26  # limits of the record on screen


class Record:
    """Ring buffer of the last pings of a tow."""

    # Rows run against the ping numbers, so that the newest is the upper one; columns run from far port over nadir to
    # far starboard, as the record is read.

    def __init__(self, pings: int, bins: int) -> None:
        self.amplitude = np.zeros((pings, 2 * bins), dtype=np.float32)
        self.ping = np.full(pings, -1, dtype=np.int64)
        self.stamp = np.full(pings, -1, dtype=np.int64)
        self.altitude = np.full(pings, np.nan)
        self.error = np.full(pings, np.nan)

    @property
    def pings(self) -> int:
        """Number of rows."""
        return len(self.ping)

    @property
    def bins(self) -> int:
        """Range bins per side."""
        return self.amplitude.shape[1] // 2

    def rows(self, pings: Integers) -> Integers:
        """Rows that hold these pings, or would hold them."""
        return self.pings - 1 - pings % self.pings

    def put(
        self,
        pings: Integers,
        amplitude: Singles,
        stamp: int | Integers,
        altitude: Floats | None = None,
        error: Singles | None = None,
    ) -> Integers:
        """Store traced pings."""
        rows = self.rows(pings)
        self.amplitude[rows, : self.bins] = amplitude[:, 0, ::-1]
        self.amplitude[rows, self.bins :] = amplitude[:, 1]
        self.ping[rows] = pings
        self.stamp[rows] = stamp
        self.altitude[rows] = np.nan if altitude is None else altitude
        self.error[rows] = np.nan if error is None else error
        return rows

    def shown(self, newest: int) -> Integers:
        """Numbers of the pings on screen below the given newest one, newest first; the tow starts at ping 0."""
        return np.arange(newest, max(newest - self.pings, -1), -1, dtype=np.int64)

    def missing(self, newest: int, stamp: int) -> Integers:
        """Pings on screen that the record lacks, or that were traced for a request older than ``stamp``."""
        pings = self.shown(newest)
        rows = self.rows(pings)
        return pings[(self.ping[rows] != pings) | (self.stamp[rows] < stamp)]

    def blank(self, newest: int) -> int:
        """Count the pings on screen that the record lacks altogether."""
        pings = self.shown(newest)
        return int((self.ping[self.rows(pings)] != pings).sum())

    def altitude_of(self, pings: Integers) -> Floats:
        """Altitudes of pings in metres; 0 where they are not known or not stored."""
        rows = self.rows(pings)
        return np.where(self.ping[rows] == pings, np.nan_to_num(self.altitude[rows]), 0.0)

    def error_of(self, ping: int) -> float:
        """Estimated error of a ping; NaN where it is not known or not stored."""
        row = int(self.rows(np.array([ping]))[0])
        return float(self.error[row]) if self.ping[row] == ping else float("nan")

    @property
    def lowest(self) -> float:
        """Least altitude of the stored pings, in metres; NaN if none is known."""
        known = self.altitude[np.isfinite(self.altitude) & (self.ping >= 0)]
        return float(known.min()) if known.size else float("nan")

    def amplitude_at(self, ping: int, side: int, range_bin: int) -> float | None:
        """Amplitude of one bin (side 0 is port); None if the ping is not stored."""
        row = int(self.rows(np.array([ping]))[0])
        if self.ping[row] != ping or not 0 <= range_bin < self.bins:
            return None
        column = self.bins - 1 - range_bin if side == 0 else self.bins + range_bin
        return float(self.amplitude[row, column])


def pings_held(scene: Scene) -> int:
    """Count the pings of a scene's track that the record on screen holds."""
    return min(scene.track.pings, MAX_PINGS, MAX_CELLS // (2 * scene.sonar.bins))


@dataclass(frozen=True)
class RecordGrowth:
    """Pings that the record on screen has just taken over."""

    answer: TracedPings  # the traced pings and the simulation that traced them
    record: Record  # all pings on screen
    current: bool  # whether the pings are traced at full accuracy and belong to the scene as it is now
    complete: bool  # whether no ping on screen is missing
