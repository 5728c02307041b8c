"""Comparison of two modellings of a scene: difference of the records, and ratio of the times."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.error_range import ERROR_ALTITUDES
from insonify_viewer.modelling import Modelling

if TYPE_CHECKING:
    from insonify.scene import Scene
    from insonify_viewer.record import Record

FEWEST = 16  # pings that two records must have in common


@dataclass(frozen=True, eq=False)
class RecordSnapshot:
    """Copy of the record of a scene under one modelling.

    Attributes
    ----------
    scene, modelling
        Its scene and modelling.
    ping : (n,) int64
        Numbers of the pings.
    intensity : (n, 2 bins) float32
        Relative to a level bed, from far port to far starboard.
    seconds : float
        Time to trace a ping.
    """

    scene: Scene
    modelling: Modelling
    ping: NDArray[np.int64]
    intensity: NDArray[np.float32]
    seconds: float

    @classmethod
    def of(cls, record: Record, scene: Scene, modelling: Modelling, seconds: float) -> RecordSnapshot:
        """Copy the pings of a record."""
        held = record.ping >= 0
        return cls(scene, modelling, record.ping[held], np.square(record.amplitude[held]), seconds)


def relative_difference(before: RecordSnapshot, after: RecordSnapshot) -> float | None:
    """Relative difference of two records of one scene.

    Parameters
    ----------
    before, after : RecordSnapshot
        Records with the same bins.

    Returns
    -------
    float or None
        rms of the difference over that of the record before, beyond 1.4 altitudes, as the error of a method is given;
        None if they have too few pings in common.
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
    power = float(np.vdot(one, one))
    moved = after.intensity[np.ix_(theirs, columns)] - one
    return float(np.sqrt(np.vdot(moved, moved) / power)) if power > 0.0 else None


def changed_subject(before: Modelling, after: Modelling) -> str:
    """Subject by which two modellings differ; empty if there are several, or none."""
    subjects = {subject for subject, _ in {*before.forced} ^ {*after.forced}}
    return subjects.pop() if len(subjects) == 1 and before.tolerance == after.tolerance else ""


def difference_in_words(share: float | None, times: float) -> str:
    """Write a difference and a ratio of times: "changes the record by 0.4 %, takes 1.8 × the time"."""
    record = (
        "changes nothing of the record" if share == 0.0 else f"changes the record by {100.0 * (share or 0.0):.2g} %"
    )
    return f"{record + ', ' if share is not None else ''}takes {times:.2g} × the time"
