"""Speckle: many scatterers in a cell interfere, and where there are few their number shows too."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import special

from insonify.acoustics.pulses import coherent_taps, pulse_taps
from insonify.acoustics.resolution_cell import along_track_angle, bin_centres, coherence_angle
from insonify.kernels.common.types import SceneArrays
from insonify.kernels.speckle.random_fields import transform_distribution
from insonify.receiver.random_fields import Field, make_field
from insonify.scene import Scene
from insonify.scene.speckles.coherent import Coherent
from insonify.scene.speckles.k import K
from insonify.scene.speckles.none import NoSpeckle

SPECKLE_STREAM, TEXTURE_STREAM = 1000, 2000
SMALLEST_SHAPE, LARGEST_SHAPE = 0.05, 1e4
ROWS = 8  # of the table, per doubling of the shape
COLUMNS = 16  # per doubling of the exponential number
FIRST_COLUMN, LAST_COLUMN = -12.0, 5.5  # log₂ of that number; beyond 2^5.5 lies 1 in 10¹⁹


@dataclass(frozen=True, eq=False)
class Texture:
    """Strength of the bed about its mean, gamma-distributed.

    Attributes
    ----------
    field : Field
        Exponential numbers that keep together as cells overlap.
    shape : float
        ν of the gamma distribution, in a cell of the size that it refers to.
    growth : (bins,) float64
        Size of the cells there over that one.
    """

    field: Field
    shape: float
    growth: NDArray[np.float64]

    def strengths(
        self, pings: NDArray[np.int64], inverse_shape: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Gamma numbers of mean 1 and variance 1/ν, (n, 2, bins); ν as each bin's ground has it, or the receiver's."""
        strengths = self.field.energies(pings)
        shape = self.shape if inverse_shape is None else 1.0 / np.maximum(inverse_shape, 1.0 / LARGEST_SHAPE)
        octaves = np.log2(np.clip(shape * self.growth, SMALLEST_SHAPE, LARGEST_SHAPE) / SMALLEST_SHAPE)
        place = np.broadcast_to(octaves * ROWS, strengths.shape).astype(np.float32)
        transform_distribution(strengths, shape_table(), FIRST_COLUMN, COLUMNS, np.ascontiguousarray(place))
        return strengths


@dataclass(frozen=True, eq=False)
class Speckle:
    """What the receiver multiplies every bin by.

    Attributes
    ----------
    field : Field
        Interference of scatterers.
    looks : int
        Independent records averaged.
    texture : Texture or None
        For K speckle.
    """

    field: Field
    looks: int
    texture: Texture | None

    @property
    def inverse_shape(self) -> float:
        """1/ν of the receiver's own shape; 0 for Rayleigh speckle."""
        return 0.0 if self.texture is None else 1.0 / self.texture.shape

    def factors(
        self, pings: NDArray[np.int64], inverse_shape: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]:
        """Numbers of mean 1, (n, 2, bins); for K speckle by 1/ν of each bin's ground, or the receiver's own."""
        factors = self.field.energies(pings, self.looks)
        return factors if self.texture is None else factors * self.texture.strengths(pings, inverse_shape)


def make_speckle(scene: Scene, arrays: SceneArrays) -> Speckle | None:
    """Derive a scene's speckle, None where it has none.

    Along range, scatterers interfere as far as the pulse reaches. Along the track two pings d apart hear the same
    scatterers at an angle φ with phases 2kdφ apart, so that their amplitudes correlate as the transform of the beam's
    two-way energy, sin(kdθ)/(kdθ) for a fan (the theorem of van Cittert and Zernike; Goodman, Speckle Phenomena in
    Optics): ∫|ρ|² = λ/2θ, half an array's length at any range. The strength of the bed itself has no phase: it stays
    the same as long as cells overlap, rθ along the track.
    """
    declared = scene.receiver.speckle
    if isinstance(declared, NoSpeckle):
        return None
    speed, pulse = arrays.water.reference, scene.sonar.pulse
    taps = coherent_taps(pulse, speed, arrays.bin_length)
    advance = scene.track.speed / scene.sonar.ping_rate
    wavelength = speed / scene.sonar.frequency
    field = make_field(scene.seed, SPECKLE_STREAM, taps, 0.5 * wavelength / coherence_angle(arrays) / advance)
    if isinstance(declared, Coherent):
        return Speckle(field, 1, None)  # of the water; the bed's own scatterers interfere one by one
    if not isinstance(declared, K):
        return Speckle(field, declared.looks, None)  # type: ignore[attr-defined]
    width = along_track_angle(arrays) * bin_centres(arrays)
    length = float(pulse_taps(pulse, speed, arrays.bin_length).weights.sum()) * arrays.bin_length
    growth = np.ones(arrays.bins) if declared.cell is None else width * length / declared.cell
    texture = Texture(make_field(scene.seed, TEXTURE_STREAM, taps, width / advance), declared.shape, growth)
    return Speckle(field, declared.looks, texture)


def divide_by_shape(scene: Scene, arrays: SceneArrays, k_shapes: Sequence[float | None]) -> NDArray[np.float64] | None:
    """Divide the reflectivity of every material by the shape of its K speckle.

    Parameters
    ----------
    scene : Scene
        Its speckle applies.
    arrays : SceneArrays
        With the reflectivities of all materials.
    k_shapes : sequence of float or None
        By row of those; None where the receiver's own shape holds.

    Returns
    -------
    (materials, 3) float64 or None
        None where no material has a shape of its own. The exponent of the lobe stays as it is.
    """
    speckle = scene.receiver.speckle
    if not isinstance(speckle, K) or all(shape is None for shape in k_shapes):
        return None
    shapes = np.array([shape or speckle.shape for shape in k_shapes])
    divided: NDArray[np.float64] = arrays.reflectivity / np.stack([shapes, shapes, np.ones(shapes.size)], axis=1)
    return divided


@lru_cache(maxsize=1)
def shape_table() -> NDArray[np.float32]:
    """Turn exponential numbers E into gamma numbers T of the same rank and mean 1.

    Returns
    -------
    (rows, columns) float32
        log₂ T; rows at steps of 1/8 of log₂ ν, columns at steps of 1/16 of log₂ E. T = E for ν = 1, and T grows as
        E^(1/ν) below the table. Read between its rows and columns it keeps mean and variance to 0.1 %.
    """
    octaves = math.ceil(math.log2(LARGEST_SHAPE / SMALLEST_SHAPE) * ROWS)
    shape = SMALLEST_SHAPE * 2.0 ** (np.arange(octaves + 1)[:, None] / ROWS)
    energy = 2.0 ** np.arange(FIRST_COLUMN, LAST_COLUMN + 0.5 / COLUMNS, 1.0 / COLUMNS)
    few, many = energy[energy < 1.0], energy[energy >= 1.0]
    # Each half by the tail that is small.
    low, high = special.gammaincinv(shape, -np.expm1(-few)), special.gammainccinv(shape, np.exp(-many))
    return np.log2(np.concatenate([low, high], axis=1) / shape).astype(np.float32)
