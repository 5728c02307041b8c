"""Pulses after the receiver's filter: the echo of a point, and the energy and coherence it gives neighbouring bins."""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats
from insonify.scene.sonar.pulses import PulseKind

RESPONSE_SAMPLES = 64  # of a response, per bin and per resolution cell
AT_ONCE = 1 << 18  # samples that are integrated together
# Resolution cells beyond which sidelobes of a response, then below 1/50, do not count for coherence.
COHERENT_CELLS = 16
MOST_SAMPLES = 1 << 25  # of summed waves: half a gigabyte


class Taps(NamedTuple):
    """Shares of the energy of a bin that a pulse spreads over the bins around it."""

    weights: Floats  # (n,) one for each bin reached, near to far
    before: int  # number of bins reached that are nearer than the bin itself


def envelope(pulse: PulseKind, offset: Floats, sound_speed: float) -> Floats:
    """Amplitude of the echo of a point after the receiver's filter, 1 at its peak."""
    return pulse.envelope(2.0 * np.asarray(offset) / sound_speed)


def samples_per_bin(pulse: PulseKind, sound_speed: float, bin_length: float) -> int:
    """Count the samples of a bin at which waves are summed: one, or as many as the pulse resolves within the bin."""
    resolution = 0.5 * sound_speed * pulse.resolution or bin_length
    return math.ceil(min(bin_length / resolution, float(MOST_SAMPLES)) * (1.0 - 1e-9))


@lru_cache(maxsize=16)
def pulse_taps(pulse: PulseKind, sound_speed: float, bin_length: float) -> Taps:
    """Weights by which a pulse spreads the energy of a bin over range bins."""
    exact = pulse.taps(0.5 * sound_speed * pulse.length / bin_length)
    return _integrated_taps(pulse, sound_speed, bin_length) if exact is None else Taps(exact, 0)


def _integrated_taps(pulse: PulseKind, sound_speed: float, bin_length: float) -> Taps:
    """Integrals of the squared envelope over the bins that it reaches."""
    length = 0.5 * sound_speed * pulse.length
    reach = math.ceil(length / bin_length)
    before = reach if pulse.two_sided else 0
    step = min(bin_length, pulse.cell(sound_speed)) / RESPONSE_SAMPLES
    count = math.ceil(length / step)  # on either hand
    step = length / count
    weights = np.zeros(before + reach + 1)
    for first in range(-count if pulse.two_sided else 0, count, AT_ONCE):
        offset = (np.arange(first, min(first + AT_ONCE, count), dtype=np.float64) + 0.5) * step
        energy = envelope(pulse, offset, sound_speed) ** 2 * (step / bin_length)
        # Echoes lie anywhere in their bin: an offset of k + f bins falls to bin k with the share 1 - f, else to k + 1.
        place = offset / bin_length + before
        near = np.minimum(place.astype(np.int64), before + reach - 1)
        share = place - near
        weights += np.bincount(near, energy * (1.0 - share), weights.size)
        weights += np.bincount(near + 1, energy * share, weights.size)
    return Taps(weights, before)


def spread_curve(curve: Floats, taps: Taps) -> Floats:
    """Mean energies of bins, (bins,), spread by a pulse; beyond the last bin they stay as in the last."""
    beyond = np.pad(curve, (0, taps.before), "edge")
    return np.convolve(beyond, taps.weights)[taps.before :][: curve.size]


def coherence(pulse: PulseKind, sound_speed: float, bin_length: float) -> Floats:
    """Correlation of the amplitudes of range bins, for many small scatterers."""
    exact = pulse.coherence(0.5 * sound_speed * pulse.length / bin_length)
    return _integrated_coherence(pulse, sound_speed, bin_length) if exact is None else exact


def _integrated_coherence(pulse: PulseKind, sound_speed: float, bin_length: float) -> Floats:
    """Correlate the envelope with itself, sampled finely, at whole bins."""
    cell = pulse.cell(sound_speed)
    length = min(0.5 * sound_speed * pulse.length, COHERENT_CELLS * cell)
    # Finer than for taps: the pulse ends between two samples.
    per_bin = math.ceil(4 * RESPONSE_SAMPLES * bin_length / cell)
    step = bin_length / per_bin
    count = math.ceil(length / step)  # on either hand
    offset = (np.arange(-count, count, dtype=np.float64) + 0.5) * step
    response = envelope(pulse, offset, sound_speed)
    size = 4 * count  # so that the correlation does not wrap around
    correlation = np.fft.irfft(np.abs(np.fft.rfft(response, size)) ** 2, size)
    longest = (2.0 if pulse.two_sided else 1.0) * length
    lags = np.arange(max(math.ceil(longest / bin_length), 1)) * per_bin
    return correlation[lags] / correlation[0]


@lru_cache(maxsize=16)
def coherent_taps(pulse: PulseKind, sound_speed: float, bin_length: float) -> Floats:
    """Weights of a filter that gives white noise the coherence of a pulse."""
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
