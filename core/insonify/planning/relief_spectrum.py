"""Detail of a bed by its waves: what planes that lie too far apart miss, and nodes that are left out.

To first order an echo's strength goes as 1 + 2 s / tan θ with the slope s towards the sonar at grazing angle θ. So the
record has the spectrum of slopes, that of heights times (2π f)², which bins and beam average.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.planning import fitted_laws
from insonify.scene.reliefs.fractal import Fractal
from insonify.scene.reliefs.random_relief import RandomRelief
from insonify.scene.seabed import Seabed

Field = NDArray[np.float64]
FX, FY = 28, 44  # frequencies, on a logarithmic scale
LONGEST, FINEST = 1024.0, 32.0  # from cycles of so many nodes to parts of one
TAIL = 0.8  # of what corners at the nodes leave beyond

# Frequencies in cycles a node: away from the track, and along it to beyond what nodes hold.
AWAY = np.geomspace(1.0 / LONGEST, 0.5, FX)[:, None]
ALONG = np.geomspace(1.0 / LONGEST, FINEST, FY)[None, :]
STEPS = np.gradient(ALONG, axis=1)
AREAS = 4.0 * np.gradient(AWAY, axis=0) * STEPS
# Between nodes the bed is straight: cells flatten its waves, and beyond the nodes' Nyquist frequency it falls as f⁻⁴.
BETWEEN = np.sinc(AWAY) ** 4 * np.sinc(np.minimum(ALONG, 0.5)) ** 4
BETWEEN = BETWEEN * np.where(ALONG > 0.5, TAIL * (0.5 / ALONG) ** 4, 1.0)


class ReliefSpectrum(NamedTuple):
    """Waves of a bed's slopes towards the sonar, of its heights, and of its materials."""

    fx: Field  # (FX, 1) cycles a metre away from the track
    fy: Field  # (1, FY) along it, likewise
    steps: Field  # (1, FY) between those
    slopes: Field  # (FX, FY) variance of slopes as cells have them, in each cell of frequencies
    heights: Field  # (FX, FY) variance of the nodes' heights, likewise
    bends: Field  # (FX, FY) variance of slopes by which the bed bends within cells, which are flat along each axis
    edges_away: float  # cycles a metre of those, away from the track
    edges_along: float  # and along it
    steepness: float  # rms of slopes
    materials: Field  # (1, FY) variance of strengths along the track
    spacing: float  # m, of nodes


@lru_cache(maxsize=64)
def compute_relief_spectrum(seabed: Seabed, heading: float) -> ReliefSpectrum:
    """Take the waves of a bed, as one that looks athwart a heading (in degrees) meets them."""
    spacing = seabed.spacing
    fx, fy, steps = AWAY / spacing, ALONG / spacing, STEPS / spacing
    power = np.zeros((FX, FY))
    for part in _parts(seabed):
        power += _power(part, fx, np.minimum(fy, 0.5 / spacing), heading, spacing)
    variance = power * AREAS / spacing**2
    slopes = variance * (2.0 * math.pi * fx) ** 2
    steepness = math.sqrt(float((slopes * (ALONG <= 0.5)).sum()))
    return ReliefSpectrum(
        fx=fx,
        fy=fy,
        steps=steps,
        slopes=slopes * BETWEEN,
        heights=variance * (ALONG <= 0.5),
        bends=variance * _bends(heading) * (ALONG <= 0.5) / spacing**2,
        edges_away=max(abs(math.cos(math.radians(heading))), abs(math.sin(math.radians(heading)))) / spacing,
        edges_along=math.hypot(0.5 * math.sin(math.radians(2.0 * heading)), fitted_laws.EDGES) / spacing,
        steepness=steepness,
        materials=_materials(seabed, fy) * steps,
        spacing=spacing,
    )


def _bends(heading: float) -> Field:
    """Squared bend of a wave of height 1 within a cell, in slopes away from the track per cell, by its frequencies.

    Within a cell the slope along one axis of the grid does not change along it, while that of a wave of f cycles a
    cell runs through π f of itself; the variance of that is a third of its square.
    """
    s, c = math.sin(math.radians(heading)), math.cos(math.radians(heading))
    total: Field = np.zeros(np.broadcast_shapes(AWAY.shape, ALONG.shape))
    for sign in (1.0, -1.0):
        east, north = _east(AWAY, sign * np.minimum(ALONG, 0.5), heading)
        # Squared twice, for a fourth power takes numpy a hundred times as long.
        total = total + (s * east**2) ** 2 + (c * north**2) ** 2
    return 0.5 * (2.0 * math.pi) ** 2 * math.pi**2 / 3.0 * total


def _parts(seabed: Seabed) -> tuple[RandomRelief, ...]:
    """Parts of the relief; a measured bed is taken for a fractal."""
    if seabed.relief.level:
        return ()
    other = Fractal(
        beta=fitted_laws.OTHER_BETA,
        rms=fitted_laws.OTHER_RMS * seabed.spacing,
        period=fitted_laws.OTHER_PERIOD * seabed.spacing,
    )
    return seabed.random_reliefs or (other,)


def _power(part: RandomRelief, fx: Field, fy: Field, heading: float, spacing: float) -> Field:
    """Density of the heights' variance, mean of both signs of fy."""
    share = part.mask.coverage
    ahead, astern = (part.planned_density(*_east(fx, sign * fy, heading), spacing) for sign in (1.0, -1.0))
    return 0.5 * share * (ahead + astern)


def _east(away: Field, along: Field, heading: float) -> tuple[Field, Field]:
    """Frequencies along x and y from those away from the track and along it."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return along * c - away * s, along * s + away * c


def _materials(seabed: Seabed, fy: Field) -> Field:
    """Density of the variance of strengths about their mean along the track, of patches with sharp borders."""
    material = seabed.material
    if len(material.materials) == 1:
        return np.zeros_like(fy)
    strengths = np.array([of.reflectivity.diffuse for of in material.materials])
    variance = float(strengths.var() / max(strengths.mean(), 1e-9) ** 2)
    length = material.patch_length
    return np.asarray(variance * 4.0 * length / (1.0 + (2.0 * math.pi * fy * length) ** 2))
