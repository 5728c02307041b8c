"""Difference of two records of the same bins: relative rms of the intensity, and ratio of the mean levels."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.error_range import ERROR_ALTITUDES

if TYPE_CHECKING:
    from insonify.scene import Scene
    from insonify_viewer.record import Record

FEWEST = 16  # pings that two records must have in common


@dataclass(frozen=True, eq=False)
class RecordSnapshot:
    """Copy of the record of a scene.

    Attributes
    ----------
    scene : Scene
        Its scene.
    ping : (n,) int64
        Numbers of the pings.
    intensity : (n, 2 bins) float32
        Relative to a level bed, from far port to far starboard.
    """

    scene: Scene
    ping: NDArray[np.int64]
    intensity: NDArray[np.float32]

    @classmethod
    def of(cls, record: Record, scene: Scene) -> RecordSnapshot:
        """Copy the pings of a record."""
        held = record.ping >= 0
        return cls(scene, record.ping[held], np.square(record.amplitude[held]))


class RecordDifference(NamedTuple):
    """Difference of a record from the one before it, beyond 1.4 altitudes, as the error of a method is given.

    Attributes
    ----------
    share : float
        rms of the difference of the intensities over the rms of the record before.
    decibels : float
        Ratio of the mean intensities in dB; NaN where the record after is silent.
    """

    share: float
    decibels: float

    def in_words(self) -> str:
        """Write the difference: "changes the record by 12 %, its mean level by +0.8 dB"."""
        if self.share == 0.0:
            return "changes nothing of the record"
        percent = 100.0 * self.share
        words = f"changes the record by {percent:.2g} %" if percent < 99.5 else f"changes the record by {percent:.0f} %"
        if math.isfinite(self.decibels) and abs(self.decibels) >= 0.005:
            words += f", its mean level by {self.decibels:+.2g} dB".replace("-", "−")
        return words


def are_comparable(before: Scene, after: Scene) -> bool:
    """Whether the records of two scenes have the same bins."""
    return (before.sonar.bins, before.sonar.range) == (after.sonar.bins, after.sonar.range)


def compare_records(before: RecordSnapshot, after: RecordSnapshot) -> RecordDifference | None:
    """Compare two records with the same bins, ping by ping.

    Parameters
    ----------
    before, after : RecordSnapshot
        The scene of the record before says which bins lie beyond 1.4 altitudes.

    Returns
    -------
    RecordDifference or None
        None if they have too few pings in common, or the record before is silent.
    """
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
    return RecordDifference(share, 10.0 * math.log10(ratio) if ratio > 0.0 else math.nan)
