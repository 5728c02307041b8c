"""Mean intensities of reverberation and ambient noise, and the time-varied gain of every bin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.absorption import absorption_coefficient
from insonify.acoustics.resolution_cell import bin_centres, surface_echo, volume_echo
from insonify.kernels.common.types import SceneArrays
from insonify.scene import Scene
from insonify.scene.receiver.gains import RangeBins
from insonify.scene.receiver.reverberations import ReverberationKind

Curve = NDArray[np.float64]
SMALLEST = float(np.finfo(np.float32).tiny)  # intensity that stands for the noise floor where there is no noise
GREATEST_GAIN = 330.0  # dB, of source level and gain together: float32 ends at 385 dB


def power(level: float) -> float:
    """Ratio of powers of a level in decibels."""
    return float(10.0 ** (level / 10.0))


def reverberation(declared: ReverberationKind, arrays: SceneArrays, altitude: float, depth: float) -> Curve:
    """Mean intensity of volume and surface reverberation for a pulse of one bin, (bins,); 0 where none is declared."""
    echo = np.zeros(arrays.bins)
    if declared.of_volume is not None:
        echo += power(declared.of_volume) * volume_echo(arrays, altitude, depth)
    if declared.of_surface is not None:
        echo += power(declared.of_surface) * surface_echo(arrays, depth)
    return echo


def noise_level(scene: Scene) -> float:
    """Mean intensity of the ambient noise before the time-varied gain."""
    noise = scene.receiver.noise
    return 0.0 if noise is None else power(noise.level)


def crosstalk(scene: Scene) -> float:
    """Share of the energy of each channel that leaks into the other."""
    level = scene.receiver.crosstalk
    return 0.0 if level is None else power(level)


def time_varied_gain(scene: Scene, arrays: SceneArrays, echo: Curve, noise: float, depth: float) -> Curve:
    """Factor of intensity by which the time-varied gain lifts every bin."""
    r = bin_centres(arrays)
    bins = RangeBins(np.arange(r.size, dtype=np.float64), r, 2.0 * r / arrays.water.reference)
    if scene.receiver.tvg.stops_at_noise:
        audible = np.flatnonzero(echo > max(noise, SMALLEST))
        last = audible[-1] if audible.size else 0
        bins = RangeBins(*(np.minimum(column, column[last]) for column in bins))
    absorption = absorption_coefficient(scene.water.absorption, scene.sonar.frequency, abs(depth))
    decibels = scene.receiver.tvg.decibels(bins, absorption)
    return np.asarray(10.0 ** (np.minimum(decibels, GREATEST_GAIN - scene.receiver.source_level) / 10.0))
