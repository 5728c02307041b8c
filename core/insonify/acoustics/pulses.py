"""Pulses as the receiver hears them: the echo of a point, and what a bin holds of its neighbours."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.scene.pulses import PulseKind
from insonify.scene.pulses.chirp import Chirp
from insonify.scene.pulses.ideal import Ideal
from insonify.scene.pulses.tone import Tone

# A chirp's spectrum is a + b cos(2πf/B) over its band.
WINDOWS = {"uniform": (1.0, 0.0), "hamming": (0.54, 0.46), "hann": (0.5, 0.5)}
SAMPLES = 64  # of a chirp's response, per bin and per resolution cell
AT_ONCE = 1 << 18  # of them
# Sidelobes of a response further off than this many resolution cells are left out of coherence: they are below 1/50.
COHERENT_CELLS = 16


class Taps(NamedTuple):
    """Share of a bin's energy that a pulse puts into the bins about it.

    Attributes
    ----------
    weights : (n,) float64
        From the nearest bin reached to the farthest.
    before : int
        How many of them lie nearer than the echo's own bin.
    """

    weights: NDArray[np.float64]
    before: int


def envelope(pulse: Tone | Chirp, offset: NDArray[np.float64], sound_speed: float) -> NDArray[np.float64]:
    """Amplitude of a point's echo after the receiver's filter, 1 at its peak.

    Parameters
    ----------
    pulse : Tone or Chirp
        A gated tone is heard as it was sent; a chirp through the filter that matches it.
    offset : float64 array
        Slant range beyond the point's own, in metres.
    sound_speed : float
        m/s.

    Returns
    -------
    float64 array
        Signed for a chirp: the transform of its spectrum's window, sinc x for a uniform one with x = 2B·offset/c,
        within a pulse's length on either side.
    """
    time = 2.0 * np.asarray(offset) / sound_speed
    if isinstance(pulse, Tone):
        return np.where((time >= 0.0) & (time < pulse.duration), 1.0, 0.0)
    a, b = WINDOWS[pulse.window]
    x = pulse.bandwidth * time
    value = np.sinc(x) + (0.5 * b / a) * (np.sinc(x - 1.0) + np.sinc(x + 1.0))
    return np.where(np.abs(time) <= pulse.duration, value, 0.0)


@lru_cache(maxsize=16)
def pulse_taps(pulse: PulseKind, sound_speed: float, bin_length: float) -> Taps:
    """Spread a bin's energy over the bins that hear it.

    Parameters
    ----------
    pulse : Ideal, Tone or Chirp
    sound_speed : float
        m/s.
    bin_length : float
        True slant range of a bin, in metres.

    Returns
    -------
    Taps
        They sum to the pulse's equivalent length ∫|envelope|² dr in bins: cτ/2 for a tone; c/2B times 1, 1.36 or 1.5
        for a chirp of uniform, Hamming or Hann spectrum; 1 for an ideal pulse. A bin thus holds the mean intensity
        of the echoes of all the bed the pulse covers, as if the energy of each bin came evenly from its slant ranges.
    """
    if isinstance(pulse, Ideal):
        return Taps(np.ones(1), 0)
    length = 0.5 * sound_speed * pulse.duration / bin_length  # type: ignore[attr-defined]
    if isinstance(pulse, Tone):
        return Taps(tone_taps(length), 0)
    return _chirp_taps(pulse, sound_speed, bin_length)  # type: ignore[arg-type]


def _chirp_taps(pulse: Chirp, sound_speed: float, bin_length: float) -> Taps:
    """Integrate the response to a chirp over the bins that hear it."""
    length = 0.5 * sound_speed * pulse.duration
    reach = math.ceil(length / bin_length)
    step = min(bin_length, 0.5 * sound_speed / pulse.bandwidth) / SAMPLES
    count = math.ceil(length / step)  # on either hand
    step = length / count
    weights = np.zeros(2 * reach + 1)
    for first in range(-count, count, AT_ONCE):
        offset = (np.arange(first, min(first + AT_ONCE, count), dtype=np.float64) + 0.5) * step
        energy = envelope(pulse, offset, sound_speed) ** 2 * (step / bin_length)
        # Echoes lie anywhere in their bin: an offset of k + f bins falls to bin k with the share 1 - f, else to k + 1.
        place = offset / bin_length + reach
        near = np.minimum(place.astype(np.int64), 2 * reach - 1)
        share = place - near
        weights += np.bincount(near, energy * (1.0 - share), weights.size)
        weights += np.bincount(near + 1, energy * share, weights.size)
    return Taps(weights, reach)


def tone_taps(length: float) -> NDArray[np.float64]:
    """Share of a bin's energy that a gated tone puts into that bin and the following ones.

    Parameters
    ----------
    length : float
        Resolution of the pulse, cτ/2, in bins.

    Returns
    -------
    (n,) float64
        Taps that sum to ``length``.
    """
    edges = np.arange(math.ceil(length) + 2, dtype=np.float64)
    corners = (edges, edges - 1.0, edges - length, edges - 1.0 - length)
    ramps = [0.5 * np.maximum(corner, 0.0) ** 2 for corner in corners]
    return np.diff(ramps[0] - ramps[1] - ramps[2] + ramps[3])


def coherence(pulse: PulseKind, sound_speed: float, bin_length: float) -> NDArray[np.float64]:
    """Correlation between the amplitudes that many small scatterers give to bins apart.

    Parameters
    ----------
    pulse : Ideal, Tone or Chirp
    sound_speed : float
        m/s.
    bin_length : float
        True slant range of a bin, in metres.

    Returns
    -------
    (n,) float64
        At 0 to n - 1 bins apart, 0 beyond: the envelope's own correlation ∫h(r) h(r + Δ) dr / ∫h². For a tone it is
        1 − Δ/(cτ/2); of a chirp's response, `COHERENT_CELLS` on either hand count.
    """
    if isinstance(pulse, Ideal):
        return np.ones(1)
    length = 0.5 * sound_speed * pulse.duration / bin_length  # type: ignore[attr-defined]
    if isinstance(pulse, Tone):
        return 1.0 - np.arange(max(math.ceil(length), 1)) / length
    return _chirp_coherence(pulse, sound_speed, bin_length)  # type: ignore[arg-type]


def _chirp_coherence(pulse: Chirp, sound_speed: float, bin_length: float) -> NDArray[np.float64]:
    """Correlate the response to a chirp with itself, sampled finely, at whole bins."""
    cell = 0.5 * sound_speed / pulse.bandwidth
    length = min(0.5 * sound_speed * pulse.duration, COHERENT_CELLS * cell)
    per_bin = math.ceil(4 * SAMPLES * bin_length / cell)  # finer than for taps: the pulse ends between two samples
    step = bin_length / per_bin
    count = math.ceil(length / step)  # on either hand
    offset = (np.arange(-count, count, dtype=np.float64) + 0.5) * step
    response = envelope(pulse, offset, sound_speed)
    size = 4 * count  # so that the ends do not meet
    correlation = np.fft.irfft(np.abs(np.fft.rfft(response, size)) ** 2, size)
    lags = np.arange(max(math.ceil(2.0 * length / bin_length), 1)) * per_bin
    return correlation[lags] / correlation[0]


@lru_cache(maxsize=16)
def coherent_taps(pulse: PulseKind, sound_speed: float, bin_length: float) -> NDArray[np.float64]:
    """Weights by which white noise gets a pulse's coherence.

    Parameters as in `coherence`.

    Returns
    -------
    (n,) float64
        Weights of the bin itself and those before it; their squares sum to 1.

    References
    ----------
    Kolmogorov's factorisation: the half of the logarithm of the power spectrum that is causal is the logarithm of the
    filter's (Oppenheim & Schafer, Discrete-Time Signal Processing, on the complex cepstrum).
    """
    line = coherence(pulse, sound_speed, bin_length)
    if line.size == 1:
        return np.ones(1)
    n = 64 * max(line.size, 32)
    power = np.fft.rfft(np.concatenate([line, np.zeros(n + 1 - 2 * line.size), line[:0:-1]])).real
    cepstrum = np.fft.irfft(0.5 * np.log(np.maximum(power, 1e-7 * power.max())), n)
    cepstrum[1 : n // 2] *= 2.0
    cepstrum[n // 2 + 1 :] = 0.0
    taps = np.fft.irfft(np.exp(np.fft.rfft(cepstrum)), n)[: line.size]
    return np.asarray(taps / np.linalg.norm(taps))
