"""Fractal relief: noise filtered to a power law with peaks, after Models 1 to 3 of the paper.

Frequencies are whole cycles per period. A wave's coefficient is a hash of the seed and its frequency, so the same seed
makes the same landscape on every grid; the heights of one wave never depend on how finely the grid samples it.
"""

from __future__ import annotations

import math
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from insonify.kernels.common.hashing import wave_noise
from insonify.kernels.common.streams import RELIEF
from insonify.scene.reliefs.fractal import Fractal

Shape = tuple[int, int]
Field = NDArray[np.float64]
Waves = NDArray[np.complex128]

# Noise larger than this is made anew rather than kept: 2048 squared takes 34 MB.
KEPT_CELLS = 2048**2
WORKERS = 2
# Rows filtered at once, so that what lies between stays in the cache: half the time of the whole at once.
ROWS = 64


def fractal_heights(fractal: Fractal, shape: Shape, reference: Shape, seed: int, stream: int = RELIEF) -> Field:
    """Heights of one period of fractal relief.

    Parameters
    ----------
    fractal : Fractal
        Spectrum, and the rms that heights have on the reference grid.
    shape : (ny, nx)
        Samples per period along y and x.
    reference : (ny, nx)
        Grid on which the rms holds exactly. Every grid is scaled by its one factor, so that grids of different
        shape agree in the waves they share; one finer than the reference has a little more rms, a coarser one less.
    seed, stream : int
        What the random coefficients derive from.

    Returns
    -------
    (ny, nx) float64
        Metres above the mean, exactly periodic.
    """
    waves = coefficients(fractal, shape, seed, stream)
    scaled = waves if shape == reference else coefficients(fractal, reference, seed, stream)
    power = variance(scaled, reference)
    if power == 0.0:
        return np.zeros(shape)
    waves *= fractal.rms / math.sqrt(power)
    return sum_waves(waves, shape)


def sum_waves(waves: Waves, shape: Shape) -> Field:
    """Heights that waves make, (ny, nx); the waves are used up, which takes half the time of keeping them."""
    columns = scipy.fft.ifft(waves, axis=0, norm="forward", workers=WORKERS, overwrite_x=True)
    return np.asarray(scipy.fft.irfft(columns, n=shape[1], axis=1, norm="forward", workers=WORKERS))


def coefficients(fractal: Fractal, shape: Shape, seed: int, stream: int = RELIEF) -> Waves:
    """Coefficients of the waves, (ny, nx // 2 + 1), before they are scaled to the rms."""
    noise = wave_coefficients(seed, stream, shape, gaussian=fractal.coefficients == "gaussian")
    waves = np.empty_like(noise)
    fx, fy = frequencies(shape)

    def filtered(first: int) -> None:
        rows = slice(first, first + ROWS)
        np.multiply(noise[rows], np.sqrt(power_spectrum(fractal, fx, fy[rows])), out=waves[rows])

    with ThreadPoolExecutor(WORKERS) as pool:
        list(pool.map(filtered, range(0, shape[0], ROWS)))
    return waves


def variance(waves: Waves, shape: Shape) -> float:
    """Variance of the field that waves make, by Parseval: all but the first column stand for ±f."""
    # Products are summed as they are made: arrays of them would take ten times as long.
    every, first = waves.view(np.float64).ravel(), np.ascontiguousarray(waves[:, 0]).view(np.float64)
    return float(2.0 * np.einsum("i,i", every, every) - np.einsum("i,i", first, first))


def frequencies(shape: Shape) -> tuple[Field, Field]:
    """Cycles per period of ``irfft2``'s coefficients: fx (1, nx // 2 + 1) and fy (ny, 1)."""
    ny, nx = shape
    fy = (np.arange(ny) + ny // 2) % ny - ny // 2
    return np.arange(nx // 2 + 1, dtype=np.float64)[np.newaxis, :], fy.astype(np.float64)[:, np.newaxis]


def power_spectrum(fractal: Fractal, fx: Field, fy: Field) -> Field:
    """Squared amplitude A² of the relief's waves, up to one factor.

    Parameters
    ----------
    fractal : Fractal
        Exponents, peaks and options.
    fx, fy : float64
        Cycles per period, of shapes that broadcast.

    Returns
    -------
    float64
        Of the broadcast shape.
    """
    # A real field has as much power at −f as at f, so that every peak stands at −(fx, fy) too. Places that fall
    # together, as those of a peak at zero frequency do, count as often as they are named.
    places = Counter(place for peak in fractal.peaks for place in _places(peak, fractal.quadrants))
    power: Field = np.zeros(np.broadcast_shapes(fx.shape, fy.shape))
    for place, times in places.items():
        decay = decay_about(fractal, fx, fy, place)
        if fractal.combine == "max":
            np.maximum(power, decay, out=power)
        else:
            power += decay if times == 1 else times * decay
    return power


def half_plane(peak: tuple[float, float], quadrants: int) -> list[tuple[float, float]]:
    """Where one declared peak stands, but for its mirror images through zero frequency."""
    x, y = peak
    return [(x, y)] if quadrants == 1 else [(x, y), (x, -y)]


def _places(peak: tuple[float, float], quadrants: int) -> list[tuple[float, float]]:
    """Where one declared peak stands in the whole plane."""
    return [(sign * x + 0.0, sign * y + 0.0) for x, y in half_plane(peak, quadrants) for sign in (1.0, -1.0)]


def decay_about(fractal: Fractal, fx: Field, fy: Field, peak: tuple[float, float]) -> Field:
    """Power left of one peak at frequencies in cycles per period."""
    dx, dy = fx - peak[0], fy - peak[1]
    beta_x, beta_y = fractal.exponents
    hard = fractal.clamp == "hard"
    if fractal.decay == "isotropic":  # Models 1 and 2: F^−β
        return _level(dx**2 + dy**2, hard) ** -beta_x
    if fractal.decay != "separable":
        dx, dy = _turned(dx, dy, peak)
    if fractal.decay == "elliptic":
        return _elliptic(dx, dy, beta_x, beta_y, hard)
    # Model 3: |Δfx|^−βx |Δfy|^−βy, along the axes or, rotated, along the peak's own direction
    return _level(dx**2, hard) ** -beta_x * _level(dy**2, hard) ** -beta_y


def _level(squared: Field, hard: bool) -> Field:
    """Keep a squared distance from reaching zero, in cycles per period."""
    return np.maximum(squared, 1.0) if hard else 1.0 + squared


def _turned(dx: Field, dy: Field, peak: tuple[float, float]) -> tuple[Field, Field]:
    """Distances along the line from a peak to zero frequency, and at right angles to it."""
    length = math.hypot(*peak)
    cosine, sine = (peak[0] / length, peak[1] / length) if length > 0.0 else (1.0, 0.0)
    return cosine * dx + sine * dy, cosine * dy - sine * dx


def _elliptic(along: Field, across: Field, beta_x: float, beta_y: float, hard: bool) -> Field:
    """Power (|Δ∥|^(2βx/β) + |Δ⊥|^(2βy/β))^−β with β the mean exponent.

    It falls with exponent βx along the one axis and βy along the other, is isotropic when they are equal, and has no
    cross of slowly falling power through the peak.
    """
    beta = 0.5 * (beta_x + beta_y)
    if beta == 0.0:
        return np.ones(np.broadcast_shapes(along.shape, across.shape))
    if hard:
        along, across = np.maximum(np.abs(along), 1.0), np.maximum(np.abs(across), 1.0)
    reach = (along**2) ** (beta_x / beta) + (across**2) ** (beta_y / beta)
    return np.asarray(0.5 * reach if hard else 1.0 + reach) ** -beta


def wave_coefficients(seed: int, stream: int, shape: Shape, *, gaussian: bool) -> Waves:
    """Coefficients before the filter, kept so that a change of the spectrum costs the filter alone."""
    make = _kept_noise if shape[0] * shape[1] <= KEPT_CELLS else _kept_noise.__wrapped__
    return make(seed, stream, shape, gaussian)


@lru_cache(maxsize=4)
def _kept_noise(seed: int, stream: int, shape: Shape, gaussian: bool) -> Waves:
    return wave_noise(seed, stream, *shape, gaussian)
