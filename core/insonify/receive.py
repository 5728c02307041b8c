"""The receiver: from what a tracer hears to what the record shows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.echo import flicker, lengthen
from insonify.kernels.types import LIGHT, Problem
from insonify.scene import Scene
from insonify.scene.receiver import Rayleigh
from insonify.scene.sonar import Tone

SPECKLE_STREAM = 101


def receive(
    scene: Scene, problem: Problem, traced: NDArray[np.float32], pings: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Turn traced intensities into a record.

    Parameters
    ----------
    scene : Scene
        Its pulse, receiver and seed apply.
    problem : Problem
        The scene as it was traced.
    traced : (n, 2, bins) float32
        Intensity of an ideal pulse.
    pings : (n,) int64
        Their numbers.

    Returns
    -------
    (n, 2, bins) float32
        Intensity as received; the traced array itself where nothing applies.
    """
    record = traced
    if isinstance(scene.sonar.pulse, Tone):
        taps = tone_taps(scene.water.sound_speed * scene.sonar.pulse.duration / 2.0 / problem.bin_length)
        record = np.zeros_like(traced)
        lengthen(traced, (taps / taps.sum() if problem.law == LIGHT else taps).astype(np.float32), record)
    if isinstance(scene.receiver.speckle, Rayleigh):
        record = record.copy() if record is traced else record
        flicker(record, np.asarray(pings, dtype=np.int64), scene.seed, SPECKLE_STREAM)
    return record


def tone_taps(length: float) -> NDArray[np.float64]:
    """Share of a bin's energy that a gated tone puts into that bin and the following ones.

    Parameters
    ----------
    length : float
        Resolution of the pulse, cτ/2, in bins.

    Returns
    -------
    (n,) float64
        Taps that sum to ``length``: a bin holds the mean intensity of the echoes of all the bed the pulse covers, as
        if the energy of each bin came evenly from its slant ranges.
    """
    edges = np.arange(int(np.ceil(length)) + 2, dtype=np.float64)
    corners = (edges, edges - 1.0, edges - length, edges - 1.0 - length)
    ramps = [0.5 * np.maximum(corner, 0.0) ** 2 for corner in corners]
    return np.diff(ramps[0] - ramps[1] - ramps[2] + ramps[3])
