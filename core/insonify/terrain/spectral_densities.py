"""Spectral densities of relief in closed form.

A density P(f) holds for both signs of the frequency f in cycles a metre: the variance is its integral over the whole
plane. Wave numbers are k = 2πf, so that of a density per wave number W, with the variance ∫ W d²k, P = 4π² W.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from insonify.io.file_cache import kept_until_changed
from insonify.io.formats import reason
from insonify.scene import SceneError
from insonify.scene.autocorrelations.exponential import ExponentialAutocorrelation
from insonify.scene.autocorrelations.file import AutocorrelationFile
from insonify.scene.autocorrelations.gaussian import GaussianAutocorrelation
from insonify.scene.autocorrelations.table import TabledAutocorrelation
from insonify.scene.masks.patches import Patchy
from insonify.scene.reliefs.autocorrelated import Autocorrelated
from insonify.scene.reliefs.power_law import PowerLaw
from insonify.scene.reliefs.ripples import Ripples
from insonify.scene.reliefs.von_karman import VonKarman

Field = NDArray[np.float64]
Density = Callable[[Field, Field], Field]

REFERENCE_LENGTH = 0.01  # m, h₀
TABLED = 4096  # wave numbers at which a tabled autocorrelation is transformed
NEGATIVE = 0.1  # share of the power that no surface could have and that is left out


def power_law(relief: PowerLaw, outer: float | None = None) -> Density:
    """W(K) = w₂ (h₀K)^−γ₂, APL-UW TR 9407; it levels off at waves as long as the outer scale, where one is given."""
    strength = relief.strength * REFERENCE_LENGTH**4
    clamp = 0.0 if outer is None else (2.0 * math.pi / outer) ** 2

    def density(fx: Field, fy: Field) -> Field:
        squared = (2.0 * math.pi) ** 2 * (fx**2 + fy**2) + clamp
        # A mean height has no roughness.
        scaled = np.where(squared > 0.0, squared * REFERENCE_LENGTH**2, np.inf)
        return np.asarray(4.0 * math.pi**2 * strength * scaled ** (-0.5 * relief.exponent))

    return density


def von_karman(relief: VonKarman) -> Density:
    """P = 4πν h²/(k_n k_s) (1 + u²)^−(ν+1), u² = (k across/k_n)² + (k along/k_s)²: Goff and Jordan 1988, eq. 4."""
    across, along = relief.across / (2.0 * math.pi), relief.along / (2.0 * math.pi)
    level = 4.0 * math.pi * relief.hurst * relief.rms**2 * across * along

    def density(fx: Field, fy: Field) -> Field:
        f_along, f_across = rotate_frequencies(fx, fy, relief.heading)
        squared = (2.0 * math.pi) ** 2 * ((f_across * across) ** 2 + (f_along * along) ** 2)
        return np.asarray(level * (1.0 + squared) ** -(relief.hurst + 1.0))

    return density


def autocorrelated(relief: Autocorrelated) -> Density:
    """Transform an autocorrelation: P(k) = h² 2π ∫ ρ(r) J₀(kr) r dr (Wiener–Khinchin, the same in every direction).

    Raises
    ------
    SceneError
        If no surface has that autocorrelation, or its file cannot be read.
    """
    of, variance = relief.function, relief.rms**2
    if isinstance(of, ExponentialAutocorrelation):
        return lambda fx, fy: np.asarray(
            variance * 2.0 * math.pi * of.length**2 * (1.0 + _phase(fx, fy, of.length)) ** -1.5
        )
    if isinstance(of, GaussianAutocorrelation):
        return lambda fx, fy: np.asarray(variance * math.pi * of.length**2 * np.exp(-0.25 * _phase(fx, fy, of.length)))
    wave, power = transform_autocorrelation(autocorrelation_points(of))  # type: ignore[arg-type]

    def density(fx: Field, fy: Field) -> Field:
        # Beyond the table it goes on as k⁻³, as that of anything with corners does on the average.
        k = 2.0 * math.pi * np.hypot(fx, fy)
        beyond = np.maximum(k / wave[-1], 1.0)
        return np.asarray(variance * np.interp(k, wave, power) * beyond**-3.0)

    return density


def ripple_band(relief: Ripples, narrowest: float = 0.0) -> Density:
    """Band of waves about zero that makes the ripples' phase once moved to their own; its level is of no account.

    Parameters
    ----------
    relief : Ripples
        Wavelength and bandwidths.
    narrowest : float
        Spread that the band has at least, cycles a metre.
    """
    spread_across = max(relief.bandwidth / relief.wavelength, narrowest)
    spread_along = max(relief.bandwidth_along / relief.wavelength, narrowest)

    def density(fx: Field, fy: Field) -> Field:
        f_along, f_across = rotate_frequencies(fx, fy, relief.heading)
        return np.asarray(np.exp(-0.5 * ((f_across / spread_across) ** 2 + (f_along / spread_along) ** 2)))

    return density


def ripple_wave(relief: Ripples) -> tuple[float, float]:
    """Mean wave of ripples along x and y, cycles a metre, towards the left of their crests' heading."""
    angle = math.radians(relief.heading)
    return -math.sin(angle) / relief.wavelength, math.cos(angle) / relief.wavelength


def mask_density(mask: Patchy, narrowest: float = 0.0) -> Density:
    """Gaussian spectrum of unit variance whose rms frequency is that of waves two patches long.

    Parameters
    ----------
    mask : Patchy
        Size of the patches.
    narrowest : float
        Spread along each axis that it has at least, cycles a metre.
    """
    spread = max(mask_spread(mask), narrowest)
    level = 1.0 / (2.0 * math.pi * spread**2)
    return lambda fx, fy: np.asarray(level * np.exp(-0.5 * (fx**2 + fy**2) / spread**2))


def mask_spread(mask: Patchy) -> float:
    """Spread of a mask's spectrum along each axis, cycles a metre."""
    return 1.0 / (2.0 * math.sqrt(2.0) * mask.size)


def rotate_frequencies(fx: Field, fy: Field, heading: float) -> tuple[Field, Field]:
    """Frequencies along a heading and across it."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return c * fx + s * fy, c * fy - s * fx


def autocorrelation_points(of: TabledAutocorrelation | AutocorrelationFile) -> tuple[tuple[float, float], ...]:
    """Points of a tabled autocorrelation."""
    if isinstance(of, TabledAutocorrelation):
        return of.points
    return read_autocorrelation(of.path)


@lru_cache(maxsize=4)
def transform_autocorrelation(points: tuple[tuple[float, float], ...]) -> tuple[Field, Field]:
    """Wave numbers, and the transform there of straight lines between points of an autocorrelation.

    Raises
    ------
    SceneError
        If too much of the power is negative.
    """
    from scipy.special import itj0y0, j0, j1

    lag, value = np.array(points).T
    slope = np.diff(value) / np.diff(lag)
    wave = np.geomspace(1e-3 / lag[-1], 200.0 / np.diff(lag).min(), TABLED)
    # By parts: ∫ρ J₀(kr) r dr = ρ r J₁(kr)/k − ρ' ∫ r J₁(kr) dr / k, and ∫ r J₁(kr) dr = (∫J₀(x)dx / k − r J₀(kr)) / k.
    kr = wave[:, np.newaxis] * lag
    part = (itj0y0(kr)[0] / wave[:, np.newaxis] - lag * j0(kr)) / wave[:, np.newaxis]
    power = 2.0 * math.pi / wave * (value[-1] * lag[-1] * j1(kr[:, -1]) - np.diff(part, axis=1) @ slope)
    # Where a wave is far longer than every lag, the terms cancel; there the power is level.
    level = wave * lag[-1] < 0.05
    power[level] = power[~level][0]
    held = np.gradient(wave) * wave * power
    lost = -held[held < 0.0].sum() / np.abs(held).sum()
    if lost > NEGATIVE:
        raise SceneError(
            f"seabed.relief.function: {100 * lost:.0f} % of the power of this autocorrelation would be negative, as no "
            "surface has it; let it fall more smoothly, steepest at lag 0"
        )
    return wave, np.maximum(power, 0.0)


@kept_until_changed(maxsize=4)
def read_autocorrelation(path: str) -> tuple[tuple[float, float], ...]:
    """Read the points of an autocorrelation from a CSV file.

    Raises
    ------
    SceneError
        If it cannot be read, or its points do not begin at lag 0 with 1 and go on to larger lags.
    """
    from pydantic import ValidationError

    try:
        rows = np.genfromtxt(path, delimiter=",", comments="#", dtype=np.float64, ndmin=2)
    except (OSError, ValueError) as error:
        raise _refusal(path, f"cannot be read ({reason(error)})") from None
    # A line of names comes out as NaN.
    rows = rows[1:] if len(rows) and np.isnan(rows[0]).all() else rows
    if rows.shape[1] != 2 or not np.isfinite(rows).all():
        raise _refusal(path, "is not two columns of numbers")
    try:
        return TabledAutocorrelation(points=tuple((float(lag), float(value)) for lag, value in rows)).points
    except ValidationError:
        raise _refusal(path, "does not begin at 0, 1 and go on to larger lags") from None


def _refusal(path: str, fault: str) -> SceneError:
    return SceneError(f"seabed.relief.function.path: {path!r} {fault}; give a CSV with a lag in m and a value a line")


def _phase(fx: Field, fy: Field, length: float) -> Field:
    """(k length)²."""
    return np.asarray((2.0 * math.pi * length) ** 2 * (fx**2 + fy**2))
