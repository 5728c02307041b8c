"""Heights of made relief over one period: Gaussian fields of any spectrum, and what is made of them."""

from __future__ import annotations

import math

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from insonify.kernels.common.streams import RELIEF, RELIEF_MASK, RELIEF_PART
from insonify.scene.masks.patches import Patchy
from insonify.scene.reliefs.autocorrelated import Autocorrelated
from insonify.scene.reliefs.cascade import Cascade
from insonify.scene.reliefs.fractal import Fractal
from insonify.scene.reliefs.power_law import PowerLaw
from insonify.scene.reliefs.random_relief import RandomRelief
from insonify.scene.reliefs.ripples import Ripples
from insonify.scene.reliefs.von_karman import VonKarman
from insonify.terrain.field_transforms import mask_share, shape_ripples
from insonify.terrain.fractal_waves import (
    WORKERS,
    Field,
    Shape,
    Waves,
    fractal_heights,
    frequencies,
    sum_waves,
    variance,
    wave_coefficients,
)
from insonify.terrain.spectral_densities import (
    Density,
    autocorrelated,
    mask_density,
    power_law,
    ripple_band,
    ripple_wave,
    rotate_frequencies,
    von_karman,
)

LONGEST_WAVES = 0.35  # cycles per period that a band spreads at least, so that some wave lies in it


def periodic_heights(parts: tuple[RandomRelief, ...], shape: Shape, reference: Shape, seed: int) -> Field:
    """Heights of one period of the sum of several reliefs.

    Parameters
    ----------
    parts : tuple of relief
        All of one period; each takes random numbers of its own.
    shape : (ny, nx)
        Samples per period along y and x.
    reference : (ny, nx)
        Grid on which every rms holds exactly.
    seed : int
        What the landscape derives from.

    Returns
    -------
    (ny, nx) float64
        Metres above the mean bed, exactly periodic.
    """
    total = _heights(parts[0], 0, shape, reference, seed)
    for number, part in enumerate(parts[1:], 1):
        total += _heights(part, number, shape, reference, seed)
    return total


def _heights(part: RandomRelief, number: int, shape: Shape, reference: Shape, seed: int) -> Field:
    """Heights of one relief of a sum, where its mask lets it be."""
    heights = _unmasked(part, shape, reference, seed, RELIEF + RELIEF_PART * number)
    if isinstance(part.mask, Patchy):
        heights *= _mask(part.mask, part.period, shape, seed, RELIEF_MASK + RELIEF_PART * number)
    return heights


def _unmasked(relief: RandomRelief, shape: Shape, reference: Shape, seed: int, stream: int) -> Field:
    """Heights of one relief, everywhere."""
    if isinstance(relief, Fractal):
        return fractal_heights(relief, shape, reference, seed, stream)
    if isinstance(relief, Ripples):
        return _ripples(relief, shape, seed, stream)
    if isinstance(relief, PowerLaw):
        return sum_waves(_waves(power_law(relief), relief.period, shape, seed, stream), shape)
    heights = _unscaled(relief, shape, seed, stream)  # type: ignore[arg-type]
    scaled = heights if shape == reference else _unscaled(relief, reference, seed, stream)  # type: ignore[arg-type]
    power = float(np.mean(scaled**2))
    return heights * (relief.rms / math.sqrt(power)) if power > 0.0 else heights  # type: ignore[attr-defined]


def _unscaled(relief: VonKarman | Autocorrelated | Cascade, shape: Shape, seed: int, stream: int) -> Field:
    """Heights before they are brought to their rms.

    Those told by their autocorrelation have it exactly: random phases alone.
    """
    if isinstance(relief, Cascade):
        return _cascade(relief, shape, seed, stream)
    if isinstance(relief, VonKarman):
        return sum_waves(_waves(von_karman(relief), relief.period, shape, seed, stream), shape)
    waves = _waves(autocorrelated(relief), relief.period, shape, seed, stream, gaussian=False)
    return sum_waves(waves, shape)


def _waves(density: Density, period: float, shape: Shape, seed: int, stream: int, *, gaussian: bool = True) -> Waves:
    """Waves of a spectral density: each holds what lies within half a cycle per period of it."""
    fx, fy = frequencies(shape)
    noise = wave_coefficients(seed, stream, shape, gaussian=gaussian)
    return np.asarray(noise * (np.sqrt(density(fx / period, fy / period)) / period))


def _ripples(ripples: Ripples, shape: Shape, seed: int, stream: int) -> Field:
    """Shape the phase of the analytic signal of a narrow band of waves."""
    band, wave = ripple_band(ripples, LONGEST_WAVES / ripples.period), ripple_wave(ripples)

    def about_both(fx: Field, fy: Field) -> Field:
        return band(fx - wave[0], fy - wave[1]) + band(fx + wave[0], fy + wave[1])

    waves = _waves(about_both, ripples.period, shape, seed, stream)
    # A quarter of a wave on: the Hilbert transform in the direction in which the ripples follow one another.
    _, across = rotate_frequencies(*frequencies(shape), ripples.heading)
    level = math.sqrt(2.0 * variance(waves, shape))
    imaginary = sum_waves(-1j * np.sign(across) * waves, shape)
    real = sum_waves(waves, shape)
    return shape_ripples(ripples, real, imaginary, level)


def _cascade(cascade: Cascade, shape: Shape, seed: int, stream: int) -> Field:
    """Lognormal flux whose logarithm has the density C₁/(πf²), integrated by f^−H (Schertzer and Lovejoy 1987).

    A density C₁/(πf²) over the octaves down to a resolution λ has the variance 2 C₁ ln λ, so that the moments of the
    flux are ⟨φ^q⟩ = λ^K(q) with K(q) = C₁(q² − q).
    """
    fx, fy = frequencies(shape)
    squared = fx**2 + fy**2
    squared[0, 0] = np.inf
    noise = wave_coefficients(seed, stream, shape, gaussian=True)
    logarithm = sum_waves(noise * np.sqrt(cascade.intermittency / (math.pi * squared)), shape)
    if cascade.intermittency == 0.0:
        return sum_waves(noise * squared ** (-0.5 * (cascade.hurst + 1.0)), shape)
    waves = scipy.fft.rfft2(np.exp(logarithm), norm="forward", workers=WORKERS)
    waves *= (noise != 0.0) * squared ** (-0.5 * cascade.hurst)
    return sum_waves(waves, shape)


def _mask(mask: Patchy, period: float, shape: Shape, seed: int, stream: int) -> NDArray[np.float64]:
    """Share of the relief that a mask lets be, 0 to 1."""
    waves = _waves(mask_density(mask, LONGEST_WAVES / period), period, shape, seed, stream)
    level = math.sqrt(variance(waves, shape))
    field = sum_waves(waves, shape) / level
    # The patches cover their share of the very period, not of what periods are like in the mean.
    return mask_share(mask, field, float(np.quantile(field, 1.0 - mask.share)))
