"""Speckle of a record by the variance of its relative amplitude."""

from __future__ import annotations

import math
from functools import cache

from insonify.scene.receiver.speckles import K, NoSpeckle, Rayleigh, SpeckleKind

MOST_LOOKS = 32
SPIKY = 1.5  # times the variance of one look, beyond which the bed itself is spiky; steep relief adds nearly as much
SPIKIEST, SMOOTHEST = 0.05, 100.0  # shapes of K speckle


@cache
def variance_of_looks(looks: float) -> float:
    """Variance of amplitude over squared mean, of the mean intensity of independent looks: n Γ(n)² / Γ(n + ½)² − 1."""
    return looks * math.exp(2.0 * (math.lgamma(looks) - math.lgamma(looks + 0.5))) - 1.0


def variance_of_speckle(speckle: SpeckleKind) -> float:
    """Variance of amplitude over squared mean, of a kind of speckle; a gamma texture multiplies the second moment."""
    if not speckle.speckled:
        return 0.0
    whole = 1.0 + variance_of_looks(speckle.independent_records)
    return (whole * (1.0 + variance_of_looks(speckle.texture.shape)) if speckle.texture else whole) - 1.0


def choose_speckle(variance: float) -> SpeckleKind:
    """Speckle whose relative amplitude has a variance.

    Below half the variance of 32 looks there is none; up to 1.5 times that of one look it is Rayleigh speckle of some
    looks; beyond, K speckle of one look.
    """
    if variance < 0.5 * variance_of_looks(MOST_LOOKS):
        return NoSpeckle()
    if variance <= SPIKY * variance_of_looks(1):
        looks = min(range(1, MOST_LOOKS + 1), key=lambda count: abs(math.log(variance_of_looks(count) / variance)))
        return Rayleigh(looks=looks)
    texture = (1.0 + variance) / (1.0 + variance_of_looks(1)) - 1.0
    low, high = math.log(SPIKIEST), math.log(SMOOTHEST)
    for _ in range(50):  # the variance falls as the shape grows
        middle = 0.5 * (low + high)
        low, high = (middle, high) if variance_of_looks(math.exp(middle)) > texture else (low, middle)
    return K(shape=round(math.exp(low), 3))
