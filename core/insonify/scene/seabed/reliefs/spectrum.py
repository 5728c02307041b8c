"""Spectra of random relief: densities, bands about waves, and the waves of one period on a grid.

A density P(f) holds for both signs of the frequency f in cycles a metre: the variance is its integral over the whole
plane. Wave numbers are k = 2πf, so a density W per wave number, with the variance ∫ W d²k, P = 4π² W.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

from insonify.arrays import Complexes, Floats

Density = Callable[[Floats, Floats], Floats]
ROWS = 64  # rows of a group, which stay in the processor cache: half the time, little memory
LONGEST_WAVES = 0.35  # cycles per period, least spread of a band, so that it contains a wave


def row_groups(rows: int) -> Iterator[slice]:
    """Divide the rows of an array into groups of `ROWS`."""
    return (slice(first, first + ROWS) for first in range(0, rows, ROWS))


@dataclass(frozen=True, eq=False)
class Band:
    """Part of a spectrum around one wave."""

    density: Density  # spectral density S about zero, for both signs of the frequency
    feature: float  # frequency over which the density varies at its finest, cycles a metre
    # Shift of the band in cycles a metre along x and y: the spectrum is S(f − wave) + S(f + wave), or S(f) if None.
    wave: tuple[float, float] | None = None

    @property
    def highest(self) -> float:
        """Larger component of the wave, cycles a metre."""
        return 0.0 if self.wave is None else max(map(abs, self.wave))


class PeriodicWaves(Protocol):
    """Random waves of one period of a bed, sampled on a grid; frequencies are whole cycles per period."""

    @property
    def shape(self) -> tuple[int, int]:
        """Samples per period along y and x."""

    def noise(self, *, gaussian: bool = True) -> Complexes:
        """Random coefficients of unit variance, (ny, nx // 2 + 1): Gaussian, or of random phase only."""

    def filtered(self, amplitude: Density, *, gaussian: bool = True) -> Complexes:
        """Multiply the noise by an amplitude of the frequencies fx (1, nx // 2 + 1) and fy (rows, 1)."""

    def frequencies(self) -> tuple[Floats, Floats]:
        """Cycles per period of the coefficients: fx (1, nx // 2 + 1) and fy (ny, 1)."""

    def variance(self, waves: Complexes) -> float:
        """Variance of the sum of waves."""

    def field(self, waves: Complexes) -> Floats:
        """Sum of waves, (ny, nx); the array of waves is overwritten."""

    def transform(self, field: Floats) -> Complexes:
        """Waves of a field."""


def rotate_frequencies(fx: Floats, fy: Floats, heading: float) -> tuple[Floats, Floats]:
    """Frequencies along a heading and across it."""
    c, s = math.cos(math.radians(heading)), math.sin(math.radians(heading))
    return c * fx + s * fy, c * fy - s * fx
