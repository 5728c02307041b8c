"""Random relief of endless ground, tile by tile."""

from __future__ import annotations

import math
from collections.abc import Callable
from statistics import NormalDist

import numpy as np

from insonify.kernels.common.streams import RELIEF, RELIEF_MASK, RELIEF_PART
from insonify.scene.reliefs.random_relief import ExtendableRelief, RandomRelief
from insonify.scene.reliefs.spectrum import Band, Field
from insonify.terrain.endless_field import EndlessField

Tiles = Callable[[int, int], Field]


def endless_heights(parts: tuple[RandomRelief, ...], spacing: float, seed: int) -> Tiles:
    """Tiles of heights of endless ground, the sum of several random reliefs.

    Parameters
    ----------
    parts : tuple of relief
        Reliefs to add; each has its own stream of random numbers.
    spacing : float
        Metres between nodes.
    seed : int
        Seed of the landscape.

    Returns
    -------
    callable
        Function of the row and column of a tile with nodes (row · TILE + j, column · TILE + i), which returns
        (TILE, TILE) float64: metres above the mean bed.
    """
    extendable = [part for part in parts if isinstance(part, ExtendableRelief)]
    made = [_masked(part, spacing, seed, RELIEF_PART * number) for number, part in enumerate(extendable)]

    return lambda row, column: np.asarray(np.sum([part(row, column) for part in made], axis=0))


def _masked(relief: ExtendableRelief, spacing: float, seed: int, stream: int) -> Tiles:
    heights = _unmasked(relief, spacing, seed, RELIEF + stream)
    mask = relief.mask
    if mask.spread is None:
        return heights
    field = EndlessField((Band(mask.density(), mask.spread),), spacing, seed, RELIEF_MASK + stream)
    level, threshold = math.sqrt(field.variance), NormalDist().inv_cdf(1.0 - mask.coverage)
    return lambda row, column: heights(row, column) * mask.weigh(field.tile(row, column) / level, threshold)


def _unmasked(relief: ExtendableRelief, spacing: float, seed: int, stream: int) -> Tiles:
    field = EndlessField(relief.bands(), spacing, seed, stream)
    if relief.shaped:
        return _shaped(relief, field)
    rms = relief.given_rms
    if rms is None:
        return field.tile
    factor = rms / math.sqrt(field.variance) if rms > 0.0 else 0.0
    return lambda row, column: factor * field.tile(row, column)


def _shaped(relief: ExtendableRelief, field: EndlessField) -> Tiles:
    level = math.sqrt(2.0 * field.variance)

    def tile(row: int, column: int) -> Field:
        wave = field.complex_tile(row, column)
        return relief.shape_waves(wave.real, wave.imag, level)

    return tile
