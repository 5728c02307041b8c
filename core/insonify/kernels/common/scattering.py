"""How surfaces scatter: the one home of the Lambert and Phong formulas.

Sound that leaves and returns along one line, at incidence α to the surface's normal, has the shorter formulas; what
comes one way and leaves another has `bistatic`.
"""

from __future__ import annotations

import math

from insonify.kernels.common.jit import inlined_uncounted
from insonify.kernels.common.types import LIGHT, SONAR

INVERSE_PI = 1.0 / math.pi


@inlined_uncounted
def lobe(cos_squared, shininess):
    """Phong's max(0, R·V)ⁿ; monostatic, R·V = cos 2α = 2 cos²α − 1."""
    return phong(2.0 * cos_squared - 1.0, shininess)


@inlined_uncounted
def phong(mirrored, shininess):
    """Phong's max(0, R·V)ⁿ, from R·V."""
    if mirrored <= 0.0:
        return 0.0
    whole = int(shininess)
    if whole != shininess:
        return mirrored**shininess
    # Integer powers by repeated squaring are several times cheaper than pow().
    result, square = 1.0, mirrored
    while whole > 0:
        if whole & 1:
            result *= square
        square *= square
        whole >>= 1
    return result


@inlined_uncounted
def gloss(cos_squared, specular, shininess, law):
    """Phong's part of either law, from cos²α."""
    value = specular * lobe(cos_squared, shininess)
    return value if law == LIGHT else value * cos_squared * (shininess + 2.0) * (0.5 * INVERSE_PI)


@inlined_uncounted
def radiance(cos_incidence, diffuse, specular, shininess):
    """Radiance of law `light`: I = k_d cos α + k_s max(0, R·V)ⁿ (paper, Lambert and Phong)."""
    if cos_incidence <= 0.0:
        return 0.0
    return diffuse * cos_incidence + gloss(cos_incidence * cos_incidence, specular, shininess, LIGHT)


@inlined_uncounted
def backscatter(cos_incidence, diffuse, specular, shininess):
    """Backscattering cross-section of unit area, law `sonar`: cos²α (k_d/π + k_s (n+2)/(2π) cosⁿ 2α)."""
    if cos_incidence <= 0.0:
        return 0.0
    cos_squared = cos_incidence * cos_incidence
    return cos_squared * diffuse * INVERSE_PI + gloss(cos_squared, specular, shininess, SONAR)


@inlined_uncounted
def backscatter_strength(cos_incidence, diffuse, specular, shininess, law):
    """Radiance or backscattering cross-section, as the law has it."""
    if law == LIGHT:
        return radiance(cos_incidence, diffuse, specular, shininess)
    return backscatter(cos_incidence, diffuse, specular, shininess)


@inlined_uncounted
def bistatic_strength(cos_in, cos_out, mirrored, diffuse, specular, shininess, law):
    """Radiance or cross-section of unit area between two directions, ``mirrored`` being R·V.

    I = k_d cos α_in + k_s max(0, R·V)ⁿ, or σ = cos α_in cos α_out (k_d/π + k_s (n+2)/(2π) max(0, R·V)ⁿ), which is the
    same both ways.
    """
    if cos_in <= 0.0 or cos_out <= 0.0:
        return 0.0
    shine = specular * phong(mirrored, shininess)
    if law == LIGHT:
        return diffuse * cos_in + shine
    return cos_in * cos_out * (diffuse + 0.5 * (shininess + 2.0) * shine) * INVERSE_PI
