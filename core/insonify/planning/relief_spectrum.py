"""Spectra of a bed from which the errors of sparse planes and of coarse nodes are predicted.

To first order the strength of an echo varies as 1 + 2 s / tan θ with the slope s towards the sonar at grazing angle θ.
The record therefore has the spectrum of the slopes, (2π f)² times that of the heights, averaged by bins and beam.
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
FX, FY = 28, 44  # numbers of frequencies, on a logarithmic scale
LONGEST, FINEST = 1024.0, 32.0  # longest wave in nodes; highest frequency along the track in cycles per node
TAIL = 0.8  # factor of the spectrum beyond the Nyquist frequency, due to slope breaks at nodes

# Frequencies in cycles per node: away from the track, and along it to beyond the Nyquist frequency.
AWAY = np.geomspace(1.0 / LONGEST, 0.5, FX)[:, None]
ALONG = np.geomspace(1.0 / LONGEST, FINEST, FY)[None, :]
STEPS = np.gradient(ALONG, axis=1)
AREAS = 4.0 * np.gradient(AWAY, axis=0) * STEPS
# The bed is linear between nodes: cells damp its waves, and beyond the Nyquist frequency the spectrum falls as f⁻⁴.
BETWEEN = np.sinc(AWAY) ** 4 * np.sinc(np.minimum(ALONG, 0.5)) ** 4
BETWEEN = BETWEEN * np.where(ALONG > 0.5, TAIL * (0.5 / ALONG) ** 4, 1.0)


class ReliefSpectrum(NamedTuple):
    """Spectra of a bed's slopes towards the sonar, of its heights, and of the echo strength of its materials."""

    fx: Field  # (FX, 1) cycles per metre away from the track
    fy: Field  # (1, FY) cycles per metre along the track
    steps: Field  # (1, FY) widths of the intervals of fy
    slopes: Field  # (FX, FY) variance of the slopes of cells, per interval of frequencies
    heights: Field  # (FX, FY) variance of the nodes' heights, per interval of frequencies
    bends: Field  # (FX, FY) variance of slopes within cells, which are flat along each axis
    edges_away: float  # cycles per metre of the cell edges, away from the track
    edges_along: float  # cycles per metre of the cell edges, along the track
    steepness: float  # rms slope
    materials: Field  # (1, FY) variance of the echo strength along the track
    spacing: float  # of nodes, m


@lru_cache(maxsize=64)
def compute_relief_spectrum(seabed: Seabed, heading: float) -> ReliefSpectrum:
    """Compute the spectra of a bed away from and along a track of a heading (in degrees)."""
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
    """Squared change of slope within a cell, away from the track, for waves of height 1, by their frequencies.

    Within a cell the slope along an axis of the grid is constant along that axis, while the slope of a wave of f cycles
    per cell changes by π f of its amplitude; the variance of a linear change is a third of its square.
    """
    s, c = math.sin(math.radians(heading)), math.cos(math.radians(heading))
    total: Field = np.zeros(np.broadcast_shapes(AWAY.shape, ALONG.shape))
    for sign in (1.0, -1.0):
        east, north = _east(AWAY, sign * np.minimum(ALONG, 0.5), heading)
        # Squared twice, because numpy takes a hundred times as long for a fourth power.
        total = total + (s * east**2) ** 2 + (c * north**2) ** 2
    return 0.5 * (2.0 * math.pi) ** 2 * math.pi**2 / 3.0 * total


def _parts(seabed: Seabed) -> tuple[RandomRelief, ...]:
    """Random reliefs that add up to the bed; a measured bed is approximated by a fractal."""
    if seabed.relief.level:
        return ()
    other = Fractal(
        beta=fitted_laws.OTHER_BETA,
        rms=fitted_laws.OTHER_RMS * seabed.spacing,
        period=fitted_laws.OTHER_PERIOD * seabed.spacing,
    )
    return seabed.random_reliefs or (*seabed.relief.detail, other)


def _power(part: RandomRelief, fx: Field, fy: Field, heading: float, spacing: float) -> Field:
    """Spectral density of the heights, averaged over both signs of fy."""
    share = part.mask.coverage
    ahead, astern = (part.planned_density(*_east(fx, sign * fy, heading), spacing) for sign in (1.0, -1.0))
    return 0.5 * share * (ahead + astern)


def _east(away: Field, along: Field, heading: float) -> tuple[Field, Field]:
    """Frequencies along x and y, from frequencies away from the track and along it."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return along * c - away * s, along * s + away * c


def _materials(seabed: Seabed, fy: Field) -> Field:
    """Spectral density along the track of the relative echo strength of patches with sharp borders."""
    material = seabed.material
    if len(material.materials) == 1:
        return np.zeros_like(fy)
    strengths = np.array([of.reflectivity.diffuse for of in material.materials])
    variance = float(strengths.var() / max(strengths.mean(), 1e-9) ** 2)
    length = material.patch_length
    return np.asarray(variance * 4.0 * length / (1.0 + (2.0 * math.pi * fy * length) ** 2))
