"""Budget of an echo: factors in decibels that add up to it.

The echo of the parts i of a contributor is Σ σ_i g_i b_i A_i T_i: scattering strength, gain of refraction, response of
the beam, area, and the factor of the range. Each term is a mean weighted by what remains of the sum without it, so that
the product of the means is the sum itself:

    T = Σ value / Σ echo,  σ = Σ echo / Σ g b A,  g = Σ g b A / Σ b A,  b = Σ b² A / Σ b A,  A = (Σ b A)² / Σ b² A

The area is thus the one that returns as much at the mean response of the beam, which is that where the echo comes from.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.tracers.echo_parts import EchoParts

Column = NDArray[np.float64]
SILENCE = -math.inf


@dataclass(frozen=True)
class Term:
    """One term of a budget."""

    name: str  # ``spreading``, ``absorption``, …
    decibels: float
    detail: str = ""  # what it comes from, in few words


def decibels(ratio: float) -> float:
    """Decibels of a ratio of powers; minus infinity for 0."""
    return 10.0 * math.log10(ratio) if ratio > 0.0 else SILENCE


def normal_strength(reflectivity: Column, *, light: bool) -> float:
    """Scattering strength of a material at normal incidence."""
    diffuse, specular, shininess = (float(number) for number in reflectivity)
    return diffuse + specular if light else (diffuse + specular * (shininess + 2.0) / 2.0) / math.pi


def echo_terms(parts: EchoParts, normal: float, *, light: bool) -> list[Term]:
    """Terms of the echo of some parts in a pixel, before source level and receiver."""
    echo, spread, value = parts.echo.sum(), parts.spread.sum(), parts.value.sum()
    middle = float(np.average(0.5 * (parts.near + parts.far), weights=parts.value))
    terms = [
        Term("spreading", decibels(spread / echo), f"there and back over {middle:.2f} m"),
        Term("absorption", decibels(value / spread), f"there and back over {middle:.2f} m"),
    ]
    if not np.isfinite(parts.weight).all():
        return [*terms, Term("strength and area", decibels(echo), "by a path that is not straight: as one term")]
    return [*terms, *_local_terms(parts, normal, light)]


def _local_terms(parts: EchoParts, normal: float, light: bool) -> list[Term]:
    """Terms of beam, refraction, material, incidence and area."""
    local = parts.take((parts.echo > 0.0) & (parts.strength > 0.0) & (parts.width > 0.0) & (parts.gain > 0.0))
    echo, vertical = parts.echo.sum(), local.vertical
    response = local.weight / (local.gain * local.width)
    b_area = local.echo / (local.strength * local.gain)  # b A
    beam, by_vertical = np.average(response, weights=b_area), np.average(vertical, weights=b_area)
    gain = np.average(local.gain, weights=b_area)
    strength = echo / (b_area * local.gain).sum()
    incidence = math.degrees(math.acos(min(float(np.average(local.cosine, weights=local.value)), 1.0)))
    terms = [
        Term("beam along the track", decibels(beam / by_vertical), _off_axis(local)),
        Term("beam vertically", decibels(by_vertical), f"{math.degrees(-_mean(local.launch, local.echo)):.1f}° down"),
        Term("material", decibels(normal), "strength at normal incidence"),
        Term("incidence", decibels(strength / normal), f"{incidence:.0f}° from the normal"),
    ]
    if gain != 1.0:
        terms.insert(2, Term("refraction", decibels(gain), "bent rays diverge or focus"))
    area = b_area.sum() / beam
    of_area = Term("share of the bin", decibels(area), f"{area:.3g} of beam and bin")
    return [*terms, of_area if light else Term("area", decibels(area), f"{area:.3g} m² in the pixel")]


def _mean(values: Column, weights: Column) -> float:
    """Weighted mean."""
    return float(np.average(values, weights=weights))


def _off_axis(parts: EchoParts) -> str:
    """Direction of the echo from athwart, in words."""
    azimuth = math.degrees(_mean(parts.azimuth, parts.echo))
    return "athwart" if abs(azimuth) < 0.005 else f"{abs(azimuth):.2f}° towards the {'bow' if azimuth > 0 else 'stern'}"
