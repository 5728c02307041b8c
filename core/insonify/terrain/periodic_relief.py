"""Heights of random relief over one period.

Theory: docs/theory/fractal-beds.md.
"""

from __future__ import annotations

import math

import numpy as np

from insonify.kernels.common.streams import RELIEF, RELIEF_MASK, RELIEF_PART
from insonify.scene.seabed.masks import MaskKind
from insonify.scene.seabed.reliefs.random_relief import RandomRelief, density_waves
from insonify.scene.seabed.reliefs.spectrum import LONGEST_WAVES, Field, row_groups
from insonify.terrain.periodic_waves import Shape, WaveGrid


def periodic_heights(parts: tuple[RandomRelief, ...], shape: Shape, reference: Shape, seed: int) -> Field:
    """Heights of one period of the sum of several reliefs."""
    total = _heights(parts[0], 0, shape, reference, seed)
    for number, part in enumerate(parts[1:], 1):
        total += _heights(part, number, shape, reference, seed)
    return total


def unmasked_heights(relief: RandomRelief, shape: Shape, reference: Shape, seed: int, stream: int = RELIEF) -> Field:
    """Heights of one period of one relief, without its mask."""
    waves = WaveGrid(shape, seed, stream)
    return relief.heights(waves, waves if shape == reference else WaveGrid(reference, seed, stream))


def _heights(part: RandomRelief, number: int, shape: Shape, reference: Shape, seed: int) -> Field:
    """Heights of one relief of a sum, weighted by its mask."""
    heights = unmasked_heights(part, shape, reference, seed, RELIEF + RELIEF_PART * number)
    if part.mask.spread is not None:
        heights *= _mask(part.mask, part.period, WaveGrid(shape, seed, RELIEF_MASK + RELIEF_PART * number))
    return heights


def _mask(mask: MaskKind, period: float, grid: WaveGrid) -> Field:
    """Weight of a mask on its relief, 0 to 1."""
    waves = density_waves(mask.density(LONGEST_WAVES / period), period, grid)
    level = math.sqrt(grid.variance(waves))
    field = grid.field(waves)
    del waves
    field /= level
    # The patches cover their share of this very period, not only of an average period.
    threshold = float(np.quantile(field, 1.0 - mask.coverage))
    for rows in row_groups(len(field)):
        field[rows] = mask.weigh(field[rows], threshold)
    return field
