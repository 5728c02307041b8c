"""How surfaces scatter: the one home of the Lambert and Phong formulas.

Everything is monostatic: sound leaves and returns along one line, at incidence α to the surface's normal.
"""

from __future__ import annotations

import math

from numba import njit

# Every licence that keeps NaN and infinity meaningful: guards against them must survive.
FAST = {"nsz", "arcp", "contract", "afn", "reassoc"}
INVERSE_PI = 1.0 / math.pi


@njit(cache=True, nogil=True, fastmath=FAST, inline="always")
def lobe(cos_incidence, shininess):
    """Phong's max(0, R·V)ⁿ; monostatic, R·V = cos 2α = 2 cos²α − 1."""
    mirrored = 2.0 * cos_incidence * cos_incidence - 1.0
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


@njit(cache=True, nogil=True, fastmath=FAST, inline="always")
def radiance(cos_incidence, diffuse, specular, shininess):
    """Radiance of law `light`: I = k_d cos α + k_s max(0, R·V)ⁿ (paper, Lambert and Phong)."""
    if cos_incidence <= 0.0:
        return 0.0
    value = diffuse * cos_incidence
    if specular > 0.0:
        value += specular * lobe(cos_incidence, shininess)
    return value


@njit(cache=True, nogil=True, fastmath=FAST, inline="always")
def backscatter(cos_incidence, diffuse, specular, shininess):
    """Backscattering cross-section of unit area, law `sonar`: cos²α (k_d/π + k_s (n+2)/(2π) cosⁿ 2α)."""
    if cos_incidence <= 0.0:
        return 0.0
    value = diffuse * INVERSE_PI
    if specular > 0.0:
        value += specular * (shininess + 2.0) * (0.5 * INVERSE_PI) * lobe(cos_incidence, shininess)
    return value * cos_incidence * cos_incidence
