"""Made relief without an end, tile by tile."""

from __future__ import annotations

import math
from collections.abc import Callable
from statistics import NormalDist

import numpy as np

from insonify.kernels.common.streams import RELIEF, RELIEF_MASK, RELIEF_PART
from insonify.scene.autocorrelations.exponential import ExponentialAutocorrelation
from insonify.scene.autocorrelations.gaussian import GaussianAutocorrelation
from insonify.scene.masks.patches import Patchy
from insonify.scene.reliefs.autocorrelated import Autocorrelated
from insonify.scene.reliefs.cascade import Cascade
from insonify.scene.reliefs.fractal import Fractal
from insonify.scene.reliefs.power_law import PowerLaw
from insonify.scene.reliefs.random_relief import RandomRelief
from insonify.scene.reliefs.ripples import Ripples
from insonify.scene.reliefs.von_karman import VonKarman
from insonify.terrain.endless_field import Band, EndlessField
from insonify.terrain.field_transforms import mask_share, shape_ripples
from insonify.terrain.fractal_waves import Field, decay_about, half_plane
from insonify.terrain.spectral_densities import (
    Density,
    autocorrelated,
    autocorrelation_points,
    mask_density,
    mask_spread,
    power_law,
    ripple_band,
    ripple_wave,
    von_karman,
)

Tiles = Callable[[int, int], Field]


def endless_heights(parts: tuple[RandomRelief, ...], spacing: float, seed: int) -> Tiles:
    """Tiles of the sum of several reliefs.

    Parameters
    ----------
    parts : tuple of relief
        Each takes random numbers of its own.
    spacing : float
        Metres between nodes.
    seed : int
        What the landscape derives from.

    Returns
    -------
    callable
        Of a tile's row and column, whose nodes are (row · TILE + j, column · TILE + i): (TILE, TILE) float64, metres
        above the mean bed.
    """
    made = [_masked(part, spacing, seed, RELIEF_PART * number) for number, part in enumerate(parts)]

    return lambda row, column: np.asarray(np.sum([part(row, column) for part in made], axis=0))


def _masked(relief: RandomRelief, spacing: float, seed: int, stream: int) -> Tiles:
    heights = _unmasked(relief, spacing, seed, RELIEF + stream)
    if not isinstance(relief.mask, Patchy):
        return heights
    mask = relief.mask
    field = EndlessField((Band(mask_density(mask), mask_spread(mask)),), spacing, seed, RELIEF_MASK + stream)
    level, threshold = math.sqrt(field.variance), NormalDist().inv_cdf(1.0 - mask.share)
    return lambda row, column: heights(row, column) * mask_share(mask, field.tile(row, column) / level, threshold)


def _unmasked(relief: RandomRelief, spacing: float, seed: int, stream: int) -> Tiles:
    field = EndlessField(_bands_of(relief), spacing, seed, stream)
    if isinstance(relief, Ripples):
        return _ripples(relief, field)
    if isinstance(relief, PowerLaw):
        return field.tile
    factor = relief.rms / math.sqrt(field.variance) if relief.rms > 0.0 else 0.0  # type: ignore[attr-defined]
    return lambda row, column: factor * field.tile(row, column)


def _ripples(ripples: Ripples, field: EndlessField) -> Tiles:
    level = math.sqrt(2.0 * field.variance)

    def tile(row: int, column: int) -> Field:
        wave = field.complex_tile(row, column)
        return shape_ripples(ripples, wave.real, wave.imag, level)

    return tile


def _bands_of(relief: RandomRelief) -> tuple[Band, ...]:
    """Spectrum of a relief, or of the waves that it is made of."""
    if isinstance(relief, Fractal):
        return fractal_bands(relief)
    if isinstance(relief, PowerLaw):
        return (Band(power_law(relief, relief.period), 1.0 / relief.period),)
    if isinstance(relief, VonKarman):
        return (Band(von_karman(relief), 1.0 / max(relief.across, relief.along)),)
    if isinstance(relief, Ripples):
        narrow = min(relief.bandwidth, relief.bandwidth_along) / relief.wavelength
        return (Band(ripple_band(relief), narrow, ripple_wave(relief)),)
    assert not isinstance(relief, Cascade)  # which has no extent
    return (Band(autocorrelated(relief), _feature(relief)),)  # type: ignore[arg-type]


def fractal_bands(fractal: Fractal) -> tuple[Band, ...]:
    """One band a peak and its mirror image."""
    peaks = [place for peak in fractal.peaks for place in half_plane(peak, fractal.quadrants)]
    return tuple(_about(fractal, peak) for peak in peaks)


def _about(fractal: Fractal, peak: tuple[float, float]) -> Band:
    period = fractal.period

    def density(fx: Field, fy: Field) -> Field:
        return decay_about(fractal, fx * period + peak[0], fy * period + peak[1], peak)

    if peak == (0.0, 0.0):  # which is its own image
        return Band(_twofold(density), 1.0 / period)
    return Band(density, 1.0 / period, (peak[0] / period, peak[1] / period))


def _twofold(density: Density) -> Density:
    return lambda fx, fy: 2.0 * density(fx, fy)


def _feature(relief: Autocorrelated) -> float:
    """Frequency over which a spectrum changes, from how far the autocorrelation reaches."""
    of = relief.function
    if isinstance(of, ExponentialAutocorrelation | GaussianAutocorrelation):
        return 1.0 / (2.0 * math.pi * of.length)
    return 0.5 / autocorrelation_points(of)[-1][0]  # type: ignore[arg-type]
