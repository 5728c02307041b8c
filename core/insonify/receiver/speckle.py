"""Speckle as factors of intensity: Rayleigh for many scatterers in a cell, K where their density varies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from insonify.acoustics.pulses import coherent_taps, pulse_taps
from insonify.acoustics.resolution_cell import along_track_angle, bin_centres, coherence_angle
from insonify.kernels.common.streams import SPECKLE, TEXTURE
from insonify.kernels.common.types import SceneArrays
from insonify.kernels.speckle.random_fields import transform_distribution
from insonify.receiver.random_fields import WaveField, make_field
from insonify.scene import Scene

SMALLEST_SHAPE, LARGEST_SHAPE = 0.05, 1e4
ROWS = 8  # of the table of quantiles, per doubling of the shape
COLUMNS = 16  # per doubling of the exponential number
FIRST_COLUMN, LAST_COLUMN = -12.0, 5.5  # log₂ of that number; beyond 2^5.5 lies 1 number in 10¹⁹


@dataclass(frozen=True, eq=False)
class BedTexture:
    """Gamma-distributed strength of the bed about its mean, the texture of K speckle."""

    field: WaveField  # exponential numbers, correlated as far as resolution cells overlap
    shape: float  # ν of the gamma distribution in a cell of the reference size
    growth: NDArray[np.float64]  # (bins,) size of the resolution cells over the reference size

    def strengths(
        self, pings: NDArray[np.int64], inverse_shape: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Gamma numbers of mean 1 and variance 1/ν, (n, 2, bins), for the 1/ν of each bin or the receiver's own ν."""
        strengths = self.field.energies(pings)
        shape = self.shape if inverse_shape is None else 1.0 / np.maximum(inverse_shape, 1.0 / LARGEST_SHAPE)
        octaves = np.log2(np.clip(shape * self.growth, SMALLEST_SHAPE, LARGEST_SHAPE) / SMALLEST_SHAPE)
        place = np.broadcast_to(octaves * ROWS, strengths.shape).astype(np.float32)
        transform_distribution(strengths, shape_table(), FIRST_COLUMN, COLUMNS, np.ascontiguousarray(place))
        return strengths


@dataclass(frozen=True, eq=False)
class Speckle:
    """Random factors of mean 1 by which the receiver multiplies the bins."""

    field: WaveField  # energy of interfering scatterers
    looks: int  # independent records averaged
    texture: BedTexture | None  # present for K speckle

    @property
    def inverse_shape(self) -> float:
        """1/ν of the receiver's own shape; 0 for Rayleigh speckle."""
        return 0.0 if self.texture is None else 1.0 / self.texture.shape

    def factors(
        self, pings: NDArray[np.int64], inverse_shape: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Factors of mean 1, (n, 2, bins); K speckle takes the 1/ν of each bin or the receiver's own ν."""
        factors = self.field.energies(pings, self.looks)
        return factors if self.texture is None else factors * self.texture.strengths(pings, inverse_shape)

    def textured(
        self, mean: NDArray[np.float32], pings: NDArray[np.int64], inverse_shape: NDArray[np.float32] | None
    ) -> NDArray[np.float32]:
        """Mean echoes times the bed's strength in each cell: the mean over all phases of its scatterers."""
        return mean if self.texture is None else mean * self.texture.strengths(pings, inverse_shape)


def make_speckle(scene: Scene, arrays: SceneArrays) -> Speckle | None:
    """Speckle that multiplies a scene's mean echoes, None where it declares none or traces scatterers one by one.

    Along range, scatterers interfere over the length of the pulse. Along the track, two pings a distance d apart
    receive a scatterer at angle φ with phases 2kdφ apart. Their amplitudes correlate as the transform of the two-way
    beam pattern, sin(kdθ)/(kdθ) for a fan (van Cittert-Zernike theorem; Goodman, Speckle Phenomena in Optics), so that
    ∫|ρ|² = λ/2θ, half the length of an array, at any range. The texture of the bed has no phase and correlates as far
    as resolution cells overlap, rθ along the track.
    """
    declared = scene.receiver.speckle
    if not declared.speckled or declared.interferes:
        return None
    speed, pulse = arrays.water.reference, scene.sonar.pulse
    taps = coherent_taps(pulse, speed, arrays.bin_length)
    advance = scene.track.speed / scene.sonar.ping_rate
    wavelength = speed / scene.sonar.frequency
    field = make_field(scene.seed, SPECKLE, taps, 0.5 * wavelength / coherence_angle(arrays) / advance)
    looks, declared_texture = declared.independent_records, declared.texture
    if declared_texture is None:
        return Speckle(field, looks, None)
    shape, cell = declared_texture
    width = along_track_angle(arrays) * bin_centres(arrays)
    length = float(pulse_taps(pulse, speed, arrays.bin_length).weights.sum()) * arrays.bin_length
    growth = np.ones(arrays.bins) if cell is None else width * length / cell
    texture = BedTexture(make_field(scene.seed, TEXTURE, taps, width / advance), shape, growth)
    return Speckle(field, looks, texture)


def divide_by_shape(scene: Scene, arrays: SceneArrays, k_shapes: Sequence[float | None]) -> NDArray[np.float64] | None:
    """Divide the reflectivity of every material by the shape of its K speckle."""
    texture = scene.receiver.speckle.texture
    if texture is None or all(shape is None for shape in k_shapes):
        return None
    shapes = np.array([shape or texture.shape for shape in k_shapes])
    divided: NDArray[np.float64] = arrays.reflectivity / np.stack([shapes, shapes, np.ones(shapes.size)], axis=1)
    return divided


@lru_cache(maxsize=1)
def shape_table() -> NDArray[np.float32]:
    """Table from exponential numbers E to gamma numbers T of the same quantile, both of mean 1."""
    from scipy import special  # lazy: takes longer to import than a preview takes to trace

    octaves = math.ceil(math.log2(LARGEST_SHAPE / SMALLEST_SHAPE) * ROWS)
    shape = SMALLEST_SHAPE * 2.0 ** (np.arange(octaves + 1)[:, None] / ROWS)
    energy = 2.0 ** np.arange(FIRST_COLUMN, LAST_COLUMN + 0.5 / COLUMNS, 1.0 / COLUMNS)
    few, many = energy[energy < 1.0], energy[energy >= 1.0]
    # Each half is inverted by its smaller tail, which keeps its digits.
    low, high = special.gammaincinv(shape, -np.expm1(-few)), special.gammainccinv(shape, np.exp(-many))
    return np.log2(np.concatenate([low, high], axis=1) / shape).astype(np.float32)
