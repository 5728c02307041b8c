"""Mean intensities of reverberation and ambient noise, and the time-varied gain of every bin."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.absorption import NEPER_PER_DB, absorption_coefficient
from insonify.acoustics.resolution_cell import bin_centres, surface_echo, volume_echo
from insonify.kernels.common.types import SceneArrays
from insonify.scene import Scene
from insonify.scene.gains.none import NoTvg
from insonify.scene.noises.ambient import AmbientNoise
from insonify.scene.reverberations import ReverberationKind
from insonify.scene.reverberations.both import WholeReverberation
from insonify.scene.reverberations.surface import SurfaceReverberation
from insonify.scene.reverberations.volume import VolumeReverberation

Curve = NDArray[np.float64]
SMALLEST = float(np.finfo(np.float32).tiny)  # intensity that stands for the noise floor where there is no noise
GREATEST_GAIN = 330.0  # dB, of source level and gain together: float32 ends at 385 dB


def power(level: float) -> float:
    """Ratio of powers of a level in decibels."""
    return float(10.0 ** (level / 10.0))


def reverberation(declared: ReverberationKind, arrays: SceneArrays, altitude: float, depth: float) -> Curve:
    """Mean intensity of volume and surface reverberation for a pulse of one bin, (bins,); 0 where none is declared."""
    echo = np.zeros(arrays.bins)
    if isinstance(declared, (VolumeReverberation, WholeReverberation)):
        echo += power(declared.volume_strength) * volume_echo(arrays, altitude, depth)
    if isinstance(declared, (SurfaceReverberation, WholeReverberation)):
        echo += power(declared.surface_strength) * surface_echo(arrays, depth)
    return echo


def noise_level(scene: Scene) -> float:
    """Mean intensity of the ambient noise before the time-varied gain."""
    declared = scene.receiver.noise
    return power(declared.level) if isinstance(declared, AmbientNoise) else 0.0


def crosstalk(scene: Scene) -> float:
    """Share of the energy of each channel that leaks into the other."""
    level = scene.receiver.crosstalk
    return 0.0 if level is None else power(level)


def time_varied_gain(scene: Scene, arrays: SceneArrays, echo: Curve, noise: float, depth: float) -> Curve:
    """Factor of intensity by which the time-varied gain lifts every bin.

    Parameters
    ----------
    scene : Scene
    arrays : SceneArrays
    echo : (bins,) float64
        Intensity at the receiver of the echo of a level Lambert bed of albedo 1.
    noise : float
        Mean intensity of the noise.
    depth : float
        Of the sonar, in metres.

    Returns
    -------
    (bins,) float64
        10^((spreading · log₁₀ r + 2αr)/10), r in metres and α in dB/m, out to the range where that echo falls below
        the noise, and constant beyond. Source level and gain together are limited to `GREATEST_GAIN`.
    """
    declared = scene.receiver.tvg
    if isinstance(declared, NoTvg):
        return np.ones(arrays.bins)
    r = bin_centres(arrays)
    if declared.absorption is None:  # type: ignore[attr-defined]
        loss = absorption_coefficient(scene.water.absorption, scene.sonar.frequency, abs(depth))
    else:
        loss = declared.absorption * NEPER_PER_DB / 1e3  # type: ignore[attr-defined]
    audible = np.flatnonzero(echo > max(noise, SMALLEST))
    r = np.minimum(r, r[audible[-1]] if audible.size else r[0])
    decibels = declared.spreading * np.log10(r) + 2.0 * loss / NEPER_PER_DB * r  # type: ignore[attr-defined]
    return np.asarray(10.0 ** (np.minimum(decibels, GREATEST_GAIN - scene.receiver.source_level) / 10.0))
