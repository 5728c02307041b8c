"""Heights of random relief: over one period, or on any rectangle of nodes of endless ground.

Theory: docs/theory/fractal-beds.md.
"""

import math
from collections.abc import Callable
from statistics import NormalDist

import numpy as np

from insonify.arrays import Floats
from insonify.kernels.common.streams import RELIEF, RELIEF_MASK, RELIEF_PART
from insonify.scene.seabed.masks import PatchMask
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, RandomRelief, density_waves
from insonify.scene.seabed.reliefs.spectrum import LONGEST_WAVES, Band, row_groups
from insonify.terrain.endless_field import EndlessField, Nodes
from insonify.terrain.periodic_waves import GridShape, WaveGrid

Heights = Callable[[Nodes], Floats]


def periodic_heights(parts: tuple[RandomRelief, ...], shape: GridShape, reference: GridShape, seed: int) -> Floats:
    """Heights of one period of the sum of several reliefs."""
    total: Floats | None = None
    for number, part in enumerate(parts):
        heights = unmasked_heights(part, shape, reference, seed, RELIEF + RELIEF_PART * number)
        if part.mask is not None:
            heights *= _periodic_mask(part.mask, part.period, WaveGrid(shape, seed, RELIEF_MASK + RELIEF_PART * number))
        total = heights if total is None else np.add(total, heights, out=total)
    assert total is not None
    return total


def unmasked_heights(
    relief: RandomRelief, shape: GridShape, reference: GridShape, seed: int, stream: int = RELIEF
) -> Floats:
    """Heights of one period of one relief, without its mask."""
    waves = WaveGrid(shape, seed, stream)
    return relief.heights(waves, waves if shape == reference else WaveGrid(reference, seed, stream))


def _periodic_mask(mask: PatchMask, period: float, grid: WaveGrid) -> Floats:
    """Weight of a mask on its relief, 0 to 1."""
    waves = density_waves(mask.density(LONGEST_WAVES / period), period, grid)
    level = math.sqrt(grid.variance(waves))
    field = grid.field(waves)
    del waves
    field /= level
    # The patches cover their share of this very period, not only of an average period.
    threshold = float(np.quantile(field, 1.0 - mask.share))
    for rows in row_groups(len(field)):
        field[rows] = mask.weigh(field[rows], threshold)
    return field


def endless_heights(parts: tuple[RandomRelief, ...], spacing: float, seed: int) -> Heights:
    """Return a function of some nodes, which computes the heights of the sum of several endless reliefs."""
    extendable = [part for part in parts if isinstance(part, ExtendableRelief)]
    heights = [_masked(part, spacing, seed, RELIEF_PART * number) for number, part in enumerate(extendable)]
    return lambda nodes: np.asarray(np.sum([part(nodes) for part in heights], axis=0))


def _masked(relief: ExtendableRelief, spacing: float, seed: int, stream: int) -> Heights:
    heights = _unmasked(relief, EndlessField(relief.bands(), spacing, seed, RELIEF + stream))
    mask = relief.mask
    if mask is None:
        return heights
    field = EndlessField((Band(mask.density(), mask.spread),), spacing, seed, RELIEF_MASK + stream)
    level, threshold = math.sqrt(field.variance), NormalDist().inv_cdf(1.0 - mask.share)
    return lambda nodes: heights(nodes) * mask.weigh(field.values(nodes) / level, threshold)


def _unmasked(relief: ExtendableRelief, field: EndlessField) -> Heights:
    if relief.shaped:
        level = math.sqrt(2.0 * field.variance)

        def shaped(nodes: Nodes) -> Floats:
            wave = field.complex_values(nodes)
            return relief.shape_waves(wave.real, wave.imag, level)

        return shaped
    rms = relief.given_rms
    if rms is None:
        return field.values
    factor = rms / math.sqrt(field.variance) if rms > 0.0 else 0.0
    return lambda nodes: factor * field.values(nodes)
