"""Speckle: Rayleigh for many scatterers in a cell, K where their density varies, or of single traced scatterers."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Self

import numpy as np

from insonify.acoustics.pulses import coherent_taps, pulse_taps
from insonify.acoustics.resolution_cell import along_track_angle, bin_centres, coherence_angle
from insonify.arrays import Floats, Integers, Singles
from insonify.kernels.common.streams import SPECKLE, TEXTURE
from insonify.kernels.speckle.random_fields import transform_distribution
from insonify.receiver.stage import PHASES, ReceiverSetup, Sound, Stage
from insonify.receiver.waves import TrackFilters, WaveField, factor_correlation, make_field, make_filtered_field
from insonify.scene.sonar.beams import BeamConditions, BeamKind

# Within which echoes correlate: of the ping numbers, and of the noise.
MOST_STEPS, MOST_NODES = 1024, 32
RANGE_ROWS = 16  # per octave of slant range, of that correlation
SMALLEST_SHAPE, LARGEST_SHAPE = 0.05, 1e4
ROWS = 8  # of the table of quantiles, per doubling of the shape
PER_DOUBLING = 16  # per doubling of the exponential number
FIRST_COLUMN, LAST_COLUMN = -12.0, 5.5  # log₂ of that number; beyond 2^5.5 lies 1 number in 10¹⁹


@dataclass(frozen=True, eq=False)
class BedTexture:
    """Gamma-distributed strength of the bed about its mean, the texture of K speckle."""

    field: WaveField  # exponential numbers, correlated over the overlap of resolution cells
    shape: float  # ν of the gamma distribution in a cell of the reference size
    growth: Floats  # (bins,) size of the resolution cells over the reference size

    def strengths(self, pings: Integers, inverse_shape: Singles | None = None) -> Singles:
        """Gamma numbers of mean 1 and variance 1/ν, (n, 2, bins), for the 1/ν of each bin or the receiver's own ν."""
        strengths = self.field.energies(pings)
        shape = self.shape if inverse_shape is None else 1.0 / np.maximum(inverse_shape, 1.0 / LARGEST_SHAPE)
        octaves = np.log2(np.clip(shape * self.growth, SMALLEST_SHAPE, LARGEST_SHAPE) / SMALLEST_SHAPE)
        place = np.broadcast_to(octaves * ROWS, strengths.shape).astype(np.float32)
        transform_distribution(strengths, shape_table(), FIRST_COLUMN, PER_DOUBLING, np.ascontiguousarray(place))
        return strengths


@dataclass(frozen=True, eq=False)
class Speckle(Stage):
    """Random factors of mean 1, or random waves where other waves interfere with the echoes.

    Along range, scatterers interfere over the length of the pulse. Along the track, two pings a distance d apart
    receive a scatterer at angle φ with phases 2kdφ apart. Their amplitudes correlate as the transform of the two-way
    beam pattern, sin(kdθ)/(kdθ) for a fan (van Cittert-Zernike theorem; Goodman, Speckle Phenomena in Optics), so that
    ∫|ρ|² = λ/2θ at any range. Near an array its own phases count, and amplitudes correlate as its field on the bed.
    The texture of the bed has no phase. It correlates over the overlap of resolution cells, rθ along the track.
    """

    name, detail, rank = "speckle", "interference in this pixel", PHASES
    phased = True
    field: WaveField  # waves of interfering scatterers
    looks: int  # independent records averaged
    texture: BedTexture | None  # present for K speckle
    # (materials, 3) reflectivities over the shape of each material's K speckle; None where one shape holds for all.
    divided_by_shape: Floats | None

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where no speckle is declared, or scatterers are traced one by one."""
        scene, arrays, declared = setup.scene, setup.arrays, setup.scene.receiver.speckle
        if not declared.speckled or declared.interferes:
            return None
        speed, pulse = arrays.water.reference, scene.sonar.pulse
        taps = coherent_taps(pulse, speed, arrays.bin_length)
        advance = scene.track.speed / scene.sonar.ping_rate
        wavelength = speed / scene.sonar.frequency
        field = _correlated_field(setup, taps, advance)
        if field is None:
            field = make_field(scene.seed, SPECKLE, taps, 0.5 * wavelength / coherence_angle(arrays) / advance)
        looks, declared_texture = declared.independent_records, declared.texture
        if declared_texture is None:
            return cls(field, looks, None, None)
        shape, cell = declared_texture
        width = along_track_angle(arrays) * bin_centres(arrays)
        length = float(pulse_taps(pulse, speed, arrays.bin_length).weights.sum()) * arrays.bin_length
        growth = np.ones(arrays.bins) if cell is None else width * length / cell
        texture = BedTexture(make_field(scene.seed, TEXTURE, taps, width / advance), shape, growth)
        if all(each is None for each in setup.k_shapes):
            return cls(field, looks, texture, None)
        shapes = np.array([each or shape for each in setup.k_shapes])
        columns = np.stack([shapes, shapes, np.ones(shapes.size)], axis=1)
        return cls(field, looks, texture, arrays.reflectivity / columns)

    def act_on_energies(self, sound: Sound) -> None:
        """Multiply mean echoes by factors; by the texture's factors alone if waves are drawn after it."""
        inverse_shape = None  # mean of 1/ν over the echoes of a bin, by their energy; None for the receiver's own ν
        if sound.weighted is not None:
            inverse_shape = np.zeros_like(sound.energy)
            np.divide(sound.weighted, sound.energy, out=inverse_shape, where=sound.energy > 0.0)
        if not sound.sums_waves:
            sound.energy = sound.energy * self.factors(sound.pings, inverse_shape)
            return
        if self.texture is not None:
            sound.energy = sound.energy * self.texture.strengths(sound.pings, inverse_shape)
        sound.energy = sound.take_level() * sound.energy

    def act_on_waves(self, sound: Sound) -> None:
        """Add the waves of the echoes."""
        self.field.add_to(sound.waves, sound.energy, sound.pings, sound.look)

    def factors(self, pings: Integers, inverse_shape: Singles | None = None) -> Singles:
        """Factors of mean 1, (n, 2, bins), with the 1/ν of each bin or the receiver's own ν."""
        factors = self.field.energies(pings, self.looks)
        return factors if self.texture is None else factors * self.texture.strengths(pings, inverse_shape)


def _correlated_field(setup: ReceiverSetup, taps: Floats, advance: float) -> WaveField | None:
    """Waves whose correlation along the track the beam itself gives; None for one that has no phases of its own."""
    arrays, sonar = setup.arrays, setup.scene.sonar
    # Nearer than its first row the beam's pattern stays as it is.
    row = np.round(RANGE_ROWS * np.log2(np.maximum(bin_centres(arrays), arrays.pattern.first_range))).astype(np.int64)
    conditions = BeamConditions(arrays.water.reference, sonar.frequency, sonar.range)
    filters = _track_filters(sonar.beam, conditions, advance, row[0].item(), row[-1].item())
    return filters and make_filtered_field(setup.scene.seed, SPECKLE, taps, filters, row - row[0])


@lru_cache(maxsize=8)
def _track_filters(
    beam: BeamKind, conditions: BeamConditions, advance: float, first: int, last: int
) -> TrackFilters | None:
    """Return filters for the correlation of a beam's echoes at slant ranges from a first to a last row."""
    apart = beam.coherence(advance, conditions)
    if apart is None:
        return None
    step = 1 << max(math.ceil(math.log2(apart.size / MOST_STEPS)), 0)
    at = [conditions._replace(range=2.0 ** (row / RANGE_ROWS)) for row in range(first, last + 1)]
    rows = [factor_correlation(found) for each in at if (found := beam.coherence(step * advance, each)) is not None]
    weights = np.zeros((len(rows), max(row.size for row in rows)))
    for filled, row in zip(weights, rows):
        filled[: row.size] = row
    return TrackFilters(step, 1 << max(math.ceil(math.log2(weights.shape[1] / MOST_NODES)), 0), weights)


@dataclass(frozen=True, eq=False)
class CoherentSpeckle(Stage):
    """Interference of single scatterers, which the tracer sums with pulse and phases."""

    name, detail, rank = "speckle", "interference in this pixel", PHASES
    phased = coherent = True

    @classmethod
    def prepare(cls, setup: ReceiverSetup) -> Self | None:
        """None where scatterers are not traced one by one."""
        return cls() if setup.scene.receiver.speckle.interferes else None

    def act_on_energies(self, sound: Sound) -> None:
        """Split traced amplitudes into waves, if other waves are added to them."""
        sound.split_traced()

    def act_on_waves(self, sound: Sound) -> None:
        """Nothing: the waves are those that are traced."""


@lru_cache(maxsize=1)
def shape_table() -> Singles:
    """Table from exponential numbers E to gamma numbers T of the same quantile, both of mean 1."""
    from scipy import special  # lazy: takes longer to import than a preview takes to trace

    octaves = math.ceil(math.log2(LARGEST_SHAPE / SMALLEST_SHAPE) * ROWS)
    shape = SMALLEST_SHAPE * 2.0 ** (np.arange(octaves + 1)[:, None] / ROWS)
    energy = 2.0 ** np.arange(FIRST_COLUMN, LAST_COLUMN + 0.5 / PER_DOUBLING, 1.0 / PER_DOUBLING)
    few, many = energy[energy < 1.0], energy[energy >= 1.0]
    # Each half is inverted by its smaller tail, which keeps its digits.
    low, high = special.gammaincinv(shape, -np.expm1(-few)), special.gammainccinv(shape, np.exp(-many))
    return np.log2(np.concatenate([low, high], axis=1) / shape).astype(np.float32)
