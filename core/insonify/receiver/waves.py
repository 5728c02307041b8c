"""Waves of a block of pings: complex amplitudes that add before detection, and random fields of them."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from insonify.arrays import Floats, Integers, Reals, Singles
from insonify.kernels.speckle.random_fields import (
    add_detected,
    add_filtered_energy,
    add_filtered_waves,
    fill_white_noise,
    filter_noise,
    smooth_noise,
)

# ∫|ρ|² of white noise smoothed by a triangle of half width 1: its correlation ρ is the cubic B-spline.
TRIANGLE_INTERVAL = 151.0 / 140.0
SINGLE_PING = 1.0  # half width in pings up to which a triangle holds a single ping
NARROWEST_TRIANGLE = 0.5  # pings
LEAST_DENSITY = 1e-5  # of a spectrum of mean 1, so that its logarithm is finite


@dataclass(frozen=True, eq=False)
class Waves:
    """Complex amplitudes; their squared moduli are intensities."""

    real: Singles  # (n, 2, bins * samples) of pings, port and starboard; changed in place
    imaginary: Singles

    def add(self, energy: Singles, turns: Singles) -> None:
        """Add waves of given energies and phases (turns), (n or 1, 2 or 1, columns)."""
        amplitude, phase = np.sqrt(energy), np.float32(2.0 * np.pi) * turns
        np.add(self.real, amplitude * np.cos(phase), out=self.real)
        np.add(self.imaginary, amplitude * np.sin(phase), out=self.imaginary)

    def detect_into(self, record: Singles, share: float = 1.0) -> None:
        """Add a share of the energy of every bin, the mean over its samples, to a record (n, 2, bins)."""
        add_detected(self.real, self.imaginary, self.real.shape[2] // record.shape[2], np.float32(share), record)


def no_waves(pings: int, columns: int) -> Waves:
    """Waves of amplitude 0."""
    return Waves(*np.zeros((2, pings, 2, columns), np.float32))


@dataclass(frozen=True, eq=False)
class WaveField:
    """Complex Gaussian waves of mean energy 1, a function of ping, side and bin alone."""

    seed: int  # seed and stream of the hash; further looks take the following streams
    stream: int
    taps: Singles  # (m,) weights of the noise of a bin and of the bins before it; their squares sum to 1
    # (m - 1 + bins,) half width of the triangle that smooths the noise along the track, in pings, of every bin,
    # starting m - 1 bins before the first.
    half_width: Floats

    def energies(self, pings: Integers, looks: int = 1) -> Singles:
        """Mean of the energies of ``looks`` independent fields, exponential numbers each, (n, 2, bins)."""
        bins = self.half_width.size - self.taps.size + 1
        out = np.zeros((pings.size, 2, bins), np.float32)
        for look in range(looks):
            add_filtered_energy(*self._noise(pings, self.stream + look), self.taps, np.float32(1.0 / looks), out)
        return out

    def add_to(self, waves: Waves, energy: Reals, pings: Integers, look: int = 0) -> None:
        """Add the field of one look, with the given mean energy, (n or 1, 2 or 1, bins)."""
        mean = np.ascontiguousarray(energy, dtype=np.float32)
        add_filtered_waves(*self._noise(pings, self.stream + look), self.taps, mean, waves.real, waves.imaginary)

    def _noise(self, pings: Integers, stream: int) -> tuple[Singles, Singles]:
        """Complex noise of variance 1, white along range, (n, 2, m - 1 + bins) each part."""
        columns = self.half_width.size
        if self.half_width.max() <= SINGLE_PING:
            return self._white(pings, 1, slice(0, columns), stream)
        real, imaginary = np.zeros((2, pings.size, 2, columns), np.float32)
        # Spacings of nodes in pings, and the runs of bins that share them.
        spacings = 2 ** np.floor(np.log2(np.maximum(0.5 * self.half_width, 1.0))).astype(np.int64)
        edges = [0, *(np.flatnonzero(np.diff(spacings)) + 1).tolist(), spacings.size]
        for low, high in pairwise(edges):
            spacing, band = int(spacings[low]), slice(low, high)
            wide = self.half_width[band]
            # Between two and four nodes lie within the half width, so that no ping has more than eight.
            start = np.ceil((pings - wide.max()) / spacing).astype(np.int64)
            stop = np.floor((pings + wide.max()) / spacing).astype(np.int64)
            ahead = np.arange(int((stop - start).max(initial=0)) + 1)
            nodes = np.unique(start[:, None] + ahead)
            white = self._white(nodes, spacing, band, stream)
            row = np.searchsorted(nodes, start)
            per_bin = (1.0 / wide).astype(np.float32)
            smooth_noise(pings, spacing, nodes, row, per_bin, band.start, white, (real, imaginary))
        return real, imaginary

    def _white(self, nodes: Integers, spacing: int, band: slice, stream: int) -> tuple[Singles, Singles]:
        """White noise at nodes in a run of columns, (nodes, 2, columns) each part."""
        real, imaginary = np.empty((2, nodes.size, 2, band.stop - band.start), np.float32)
        first = band.start - self.taps.size + 1
        fill_white_noise(self.seed, stream, nodes, spacing.bit_length(), first, real, imaginary)
        return real, imaginary


class TrackFilters(NamedTuple):
    """Filters along the track that give white noise a known correlation, not only a known length of it."""

    step: int  # pings that have one value
    spacing: int  # steps between two nodes of the noise
    weights: Floats  # (rows, n) of the noise 0 to n - 1 steps before; of every row the squares sum to 1


@dataclass(frozen=True, eq=False)
class FilteredField(WaveField):
    """Waves whose correlation along the track follows from filters."""

    filters: TrackFilters
    edges: Integers  # (rows + 1,) columns between which each row of the filters applies

    def _noise(self, pings: Integers, stream: int) -> tuple[Singles, Singles]:
        """Complex noise of variance 1, white along range, (n, 2, m - 1 + bins) each part."""
        step, spacing, weights = self.filters
        columns, newest = self.half_width.size, pings // (step * spacing)
        nodes = np.unique(newest[:, None] - np.arange((weights.shape[1] + spacing - 1) // spacing))
        white = self._white(nodes, spacing, slice(0, columns), stream)
        real, imaginary = np.zeros((2, pings.size, 2, columns), np.float32)
        past = pings // step - newest * spacing
        row = np.searchsorted(nodes, newest)
        filter_noise(row, past, spacing, weights, self.edges, white, (real, imaginary))
        return real, imaginary


def make_filtered_field(seed: int, stream: int, taps: Floats, filters: TrackFilters, row: Integers) -> FilteredField:
    """Random field of the filters' correlation along the track, with the row of each bin, ascending from 0."""
    edges = taps.size - 1 + np.searchsorted(row, np.arange(len(filters.weights) + 1))
    edges[0] = 0
    return FilteredField(seed, stream, taps.astype(np.float32), np.zeros(edges[-1]), filters, edges)


def factor_correlation(correlation: Floats) -> Floats:
    """Weights of white noise whose sum has the given correlation: a minimum-phase factor, as long as that.

    By the cepstrum (Oppenheim and Schafer, Discrete-Time Signal Processing, 13.5).
    """
    size = 1 << max(math.ceil(math.log2(16 * correlation.size)), 10)
    spectrum = 2.0 * np.fft.rfft(correlation, size).real - correlation[0]
    cepstrum = np.fft.irfft(np.log(np.maximum(spectrum, LEAST_DENSITY)), size)
    cepstrum[0] *= 0.5
    cepstrum[size // 2 :] = 0.0
    weights = np.fft.irfft(np.exp(np.fft.rfft(cepstrum)), size)[: correlation.size]
    return np.asarray(weights / math.sqrt((weights**2).sum()))


def make_field(seed: int, stream: int, taps: Floats, interval: Floats) -> WaveField:
    """Random field with a given correlation along range and along the track."""
    wide = np.maximum(interval / TRIANGLE_INTERVAL, NARROWEST_TRIANGLE)
    early = np.full(taps.size - 1, wide[0])
    return WaveField(seed, stream, taps.astype(np.float32), np.concatenate([early, wide]))
