"""Backscattering strength of fluid sediments over frequency and grazing angle, and Lambert and Phong fitted to it.

The model is the small-slope approximation for a rough interface with a power-law spectrum, which is Kirchhoff's
approximation near nadir and first-order perturbation at other angles, and scattering by the volume below it.

References: APL-UW TR 9407 (1994), section IV; Jackson and Richardson 2007, ch. 13 and 14. Theory:
docs/theory/scattering.md.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from insonify.arrays import Complexes, Floats

WATER_SPEED = 1500.0  # m/s, from which the wave number follows
# Hz, of the measurements with which the model was compared: APL-UW TR 9407; Williams et al. 2002, IEEE J. Oceanic
# Eng. 27(3). Above, grains and shells return more than the model.
LEAST_FREQUENCY, MOST_FREQUENCY = 10e3, 300e3
LEAST_GRAZING = math.radians(10.0)  # nearer to the horizontal, the roughness casts shadows that the model leaves out
LAMBERT_GRAZING = math.radians(30.0)  # where Lambert's law is as strong as the model
STEEPEST = math.radians(89.9)  # stands for normal incidence, where first-order perturbation has a pole
LOBE_GRAZING = np.append(np.radians(np.arange(50.0, 90.0, 5.0)), STEEPEST)  # where Phong's lobe is compared with it
# Of lobes that are tried, so close that levels over frequency hardly step; whole numbers where tracers are faster with
# them.
EXPONENTS = np.concatenate([np.arange(1.0, 10.0, 0.125), np.arange(10.0, 128.0), np.geomspace(128.0, 1000.0, 100)])
LOGIT_STEP, LOGARITHM_STEP = 0.4, 0.4  # of the rules in `diffraction_integral`, exact to 0.001 dB
LOGITS, LOGARITHMS = np.arange(-30.0, 30.0, LOGIT_STEP), np.arange(-60.0, 4.0, LOGARITHM_STEP)


class Sediment(NamedTuple):
    """Fluid sediment; ratios are over water."""

    density: float  # ratio ρ
    speed_ratio: float  # ratio ν
    loss: float  # δ, imaginary over real part of the wave number
    volume: float  # σ₂, scattering cross section of the volume over the attenuation in dB, both per metre
    spectral_strength: float  # w₂ of the spectrum w₂ K^−γ of heights in both horizontal directions, cm⁴, K in 1/cm
    spectral_exponent: float  # γ, between 2 and 4


class Fit(NamedTuple):
    """Lambert's and Phong's shares, and Phong's exponent, that are nearest to the model."""

    diffuse: float
    specular: float
    shininess: float


def model_strength(sediment: Sediment, frequency: float, grazing: Floats) -> Floats:
    """Backscattering cross section of a square metre, as a ratio, by the grazing angle in radians."""
    # The volume scatters sound that is transmitted twice through a level interface: APL-UW TR 9407, IV.
    vertical, reflected = _vertical(sediment, grazing), reflection(sediment, grazing)
    numerator = 5.0 * sediment.loss * sediment.volume * np.abs(1.0 - reflected**2) ** 2 * np.sin(grazing) ** 2
    of_volume = numerator / (sediment.speed_ratio * math.log(10.0) * np.abs(vertical) ** 2 * vertical.imag)
    return np.asarray(_of_interface(sediment, frequency, grazing) + of_volume)


def scattering_strength(numbers: Sequence[Any], cos_incidence: Floats) -> Floats:
    """Backscattering cross section of a square metre by Lambert's and Phong's laws, docs/theory/scattering.md."""
    # ``numbers`` begins with the diffuse share, the specular share and the exponent.
    diffuse, specular, shininess = numbers[:3]
    mirrored = np.maximum(2.0 * cos_incidence**2 - 1.0, 0.0) ** shininess
    return np.asarray(cos_incidence**2 * (diffuse / np.pi + specular * (shininess + 2.0) / (2.0 * np.pi) * mirrored))


@lru_cache(maxsize=256)
def fit_law(sediment: Sediment, frequency: float, shininess: float) -> Fit:
    """Fit Lambert's and Phong's laws to the model at a frequency in Hz."""
    # Lambert's law is as strong as the model at 30° grazing, Phong's lobe adds what is missing at normal incidence, and
    # its exponent has the least mean square of misfits in decibels between 50° and normal incidence. The shares sum to
    # 1 at most. Without a lobe the exponent is ``shininess``.
    even = float(model_strength(sediment, frequency, np.array(LAMBERT_GRAZING)))
    diffuse = min(math.pi * even / math.sin(LAMBERT_GRAZING) ** 2, 1.0)
    model = model_strength(sediment, frequency, LOBE_GRAZING)
    missing = float(model[-1]) - diffuse / math.pi
    if missing <= 0.0:
        return Fit(diffuse, 0.0, shininess)
    specular = np.minimum(2.0 * math.pi * missing / (EXPONENTS + 2.0), 1.0 - diffuse)
    law = scattering_strength((diffuse, specular[:, None], EXPONENTS[:, None]), np.sin(LOBE_GRAZING))
    best = np.argmin(np.mean(np.log(law / model) ** 2, axis=1))
    return Fit(diffuse, float(specular[best]), float(EXPONENTS[best]))


def _of_interface(sediment: Sediment, frequency: float, grazing: Floats) -> Floats:
    """Strength of the rough interface: first-order perturbation times the ratio of exact to first-order sums.

    Jackson and Richardson 2007, 13.2.
    """
    alpha = 0.5 * sediment.spectral_exponent - 1.0
    spectral_strength = sediment.spectral_strength * 100.0 ** (sediment.spectral_exponent - 4.0)  # K in 1/m, m⁴
    wave_number = 2.0 * math.pi * frequency / WATER_SPEED
    sine, cosine = np.sin(grazing), np.cos(grazing)
    across = 2.0 * wave_number * cosine  # the wave number of the roughness that scatters backwards
    spectrum = spectral_strength * across**-sediment.spectral_exponent
    # APL-UW TR 9407, IV: first-order perturbation of a fluid half space.
    density, index, vertical = sediment.density, _index(sediment), _vertical(sediment, grazing)
    contrast = (density - 1.0) ** 2 * cosine**2 + density**2 - index**2
    first_order = 4.0 * wave_number**4 * sine**4 * np.abs(contrast / (density * sine + vertical) ** 2) ** 2 * spectrum
    # The structure function of heights over the distance R is C R^2α.
    steepness = math.gamma(1.0 - alpha) / (alpha * math.gamma(1.0 + alpha) * 2.0 ** (2.0 * alpha))
    structure = 2.0 * math.pi * spectral_strength * steepness
    roughness = 0.5 * structure * (2.0 * wave_number * sine) ** 2 * across ** (-2.0 * alpha)
    return np.asarray(first_order * diffraction_integral(roughness, alpha) * steepness / (2.0 * roughness))


def reflection(sediment: Sediment, grazing: Floats) -> Complexes:
    """Reflection coefficient of a level interface of two fluids."""
    impedance, vertical = sediment.density * np.sin(grazing), _vertical(sediment, grazing)
    return np.asarray((impedance - vertical) / (impedance + vertical))


def _index(sediment: Sediment) -> complex:
    """Wave number in the sediment over that in water."""
    return (1.0 + 1j * sediment.loss) / sediment.speed_ratio


def _vertical(sediment: Sediment, grazing: Floats) -> Complexes:
    """Vertical wave number in the sediment over the wave number in water."""
    return np.asarray(np.sqrt(_index(sediment) ** 2 - np.cos(grazing) ** 2))


def diffraction_integral(roughness: Floats, alpha: float) -> Floats:
    """Integral of u J₀(u) exp(−q u^2α) over u from 0 to infinity, for each q of ``roughness`` and 0 < α < 1.

    The exponential is the mean of exp(−B u²) over B = q^(1/α) A with a positive stable variable A of the index α, and
    the integral with exp(−B u²) is exp(−1/4B)/2B. A is a function of a uniform and an exponential variable (Kanter
    1975).
    """
    # Trapezoidal rules over the logit of the uniform variable and over the logarithm of the exponential one.
    low, high = 1.0 / (1.0 + np.exp(-LOGITS)), 1.0 / (1.0 + np.exp(LOGITS))
    angle, sine = math.pi * low, np.sin(math.pi * np.minimum(low, high))
    power = alpha / (1.0 - alpha)
    shape = np.sin(alpha * angle) ** power * np.sin((1.0 - alpha) * angle) / sine ** (power + 1.0)
    exponential = np.exp(LOGARITHMS)
    weight = (low * high * LOGIT_STEP)[:, None] * (exponential * np.exp(-exponential) * LOGARITHM_STEP)
    stable = (shape[:, None] / exponential) ** (1.0 / power)
    rates = 0.25 / (np.asarray(roughness)[..., None, None] ** (1.0 / alpha) * stable)
    return np.asarray((2.0 * rates * np.exp(-rates) * weight).sum(axis=(-2, -1)))
