"""Random relief of endless ground, on any rectangle of its nodes."""

from __future__ import annotations

import math
from collections.abc import Callable
from statistics import NormalDist

import numpy as np

from insonify.kernels.common.streams import RELIEF, RELIEF_MASK, RELIEF_PART
from insonify.scene.seabed.reliefs.random_relief import ExtendableRelief, RandomRelief
from insonify.scene.seabed.reliefs.spectrum import Band, Field
from insonify.terrain.endless_field import EndlessField, Nodes

Heights = Callable[[Nodes], Field]


def endless_heights(parts: tuple[RandomRelief, ...], spacing: float, seed: int) -> Heights:
    """Heights of endless ground, the sum of several random reliefs."""
    extendable = [part for part in parts if isinstance(part, ExtendableRelief)]
    made = [_masked(part, spacing, seed, RELIEF_PART * number) for number, part in enumerate(extendable)]

    return lambda nodes: np.asarray(np.sum([part(nodes) for part in made], axis=0))


def _masked(relief: ExtendableRelief, spacing: float, seed: int, stream: int) -> Heights:
    heights = _unmasked(relief, spacing, seed, RELIEF + stream)
    mask = relief.mask
    if mask.spread is None:
        return heights
    field = EndlessField((Band(mask.density(), mask.spread),), spacing, seed, RELIEF_MASK + stream)
    level, threshold = math.sqrt(field.variance), NormalDist().inv_cdf(1.0 - mask.coverage)
    return lambda nodes: heights(nodes) * mask.weigh(field.values(nodes) / level, threshold)


def _unmasked(relief: ExtendableRelief, spacing: float, seed: int, stream: int) -> Heights:
    field = EndlessField(relief.bands(), spacing, seed, stream)
    if relief.shaped:
        return _shaped(relief, field)
    rms = relief.given_rms
    if rms is None:
        return field.values
    factor = rms / math.sqrt(field.variance) if rms > 0.0 else 0.0
    return lambda nodes: factor * field.values(nodes)


def _shaped(relief: ExtendableRelief, field: EndlessField) -> Heights:
    level = math.sqrt(2.0 * field.variance)

    def heights(nodes: Nodes) -> Field:
        wave = field.complex_values(nodes)
        return relief.shape_waves(wave.real, wave.imag, level)

    return heights
