"""Difference of two records of the same bins: relative rms, share that changes visibly, ratio of the mean levels."""

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from insonify.arrays import Integers, Singles
from insonify.scene import Scene
from insonify_viewer.record.record import Record

FEWEST = 16  # pings that two records must have in common
FLOOR = 1e-4  # energy relative to a level bed, 40 dB below it: fainter differences fade
VISIBLE = 1.0  # dB, a thirtieth of the usual span of the palette: the least change of a bin that counts as visible
NOTHING_SEEN = 5e-4  # share below which a change is not written as a number


@dataclass(frozen=True, eq=False)
class RecordSnapshot:
    """Copy of the record of a scene."""

    scene: Scene  # its scene
    ping: Integers  # (n,) numbers of the pings
    intensity: Singles  # (n, 2 bins) relative to a level bed, from far port to far starboard

    @classmethod
    def of(cls, record: Record, scene: Scene) -> Self:
        """Copy the pings of a record."""
        held = record.ping >= 0
        return cls(scene, record.ping[held], np.square(record.amplitude[held]))


class RecordDifference(NamedTuple):
    """Difference of a record from the one before it."""

    # Rms of the difference of the intensities over the rms of the record before, beyond 1.4 altitudes, as the
    # error of a method is given. The strongest echoes rule it.
    share: float
    decibels: float  # ratio of the mean intensities in dB, beyond 1.4 altitudes; NaN where the record after is silent
    # Share of the bins lit in one record or both, at all ranges, whose level changes by 1 dB or more. Every bin
    # counts alike, as in the picture.
    visible: float

    def in_words(self) -> str:
        """Write the difference: "changes the record by 12 %, 5.3 % of its picture visibly"."""
        if self.share == 0.0:
            return "does not change the record"
        percent = 100.0 * self.share
        words = f"changes the record by {percent:.2g} %" if percent < 99.5 else f"changes the record by {percent:.0f} %"
        seen = self.visible >= NOTHING_SEEN
        words += f", {say_percent(self.visible)} of its picture visibly" if seen else ", not visibly"
        if math.isfinite(self.decibels) and abs(self.decibels) >= 0.005:
            words += f", its mean level by {self.decibels:+.2g} dB".replace("-", "−")
        return words


def are_comparable(before: Scene, after: Scene) -> bool:
    """Whether the records of two scenes have the same bins."""
    return (before.sonar.bins, before.sonar.range) == (after.sonar.bins, after.sonar.range)


def compare_records(before: RecordSnapshot, after: RecordSnapshot) -> RecordDifference | None:
    """Compare two records with the same bins, ping by ping."""
    from insonify.acoustics.flat_bed import ERROR_ALTITUDES  # lazy: imports Numba, without which the window opens

    _, ours, theirs = np.intersect1d(before.ping, after.ping, assume_unique=True, return_indices=True)
    if ours.size < FEWEST:
        return None
    bins = before.intensity.shape[1] // 2
    scene = before.scene
    r = (np.arange(bins) + 0.5) * scene.sonar.range / bins
    far = r > ERROR_ALTITUDES * abs(scene.altitude)
    columns = np.flatnonzero(np.concatenate([far[::-1], far]) if far.any() else np.ones(2 * bins, dtype=bool))
    one = before.intensity[np.ix_(ours, columns)]
    other = after.intensity[np.ix_(theirs, columns)]
    power = float(np.vdot(one, one))
    if power <= 0.0:
        return None
    ratio = float(other.sum(dtype=np.float64)) / float(one.sum(dtype=np.float64))
    moved = other - one
    share = math.sqrt(float(np.vdot(moved, moved)) / power)
    seen = visible_share(before.intensity[ours], after.intensity[theirs])
    return RecordDifference(share, 10.0 * math.log10(ratio) if ratio > 0.0 else math.nan, seen)


def visible_share(before: Singles, after: Singles) -> float:
    """Share of the bins lit in one record or both whose level changes by 1 dB or more; 0 where none is lit."""
    lit = (before > FLOOR) | (after > FLOOR)
    one, other = before[lit] + np.float32(FLOOR), after[lit] + np.float32(FLOOR)
    step = np.float32(10.0 ** (VISIBLE / 10.0))
    changed = (other >= step * one) | (one >= step * other)
    return float(np.count_nonzero(changed)) / max(changed.size, 1)


def say_percent(share: float) -> str:
    """Write a share to two digits: "3.6 %"."""
    if share < NOTHING_SEEN:
        return "< 0.1 %" if share else "0 %"
    return f"{100.0 * share:.0f} %" if share >= 0.1 else f"{100.0 * share:.2g} %"
