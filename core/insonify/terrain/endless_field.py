"""Endless Gaussian fields without period or seam, each tile a function of its place alone.

A spectrum is split into octave bands that overlap over an octave as sin² and cos² of the logarithm of frequency. The
waves of a band are hashed white noise on the coarsest lattice that samples the band, convolved with the square root of
the band by overlap-save. The sum of all coarser bands is interpolated onto each lattice by a half-band filter. The
coarsest band reaches down to frequency 0.

A narrow band around a wave p would need filters of thousands of taps on a lattice fine enough for the wave. It is made
around frequency 0 as two fields a and b of density S and modulated: a cos − b sin has the density
½ S(f − p) + ½ S(f + p). The part too near the Nyquist frequency to be modulated is made on the finest lattice.

Theory: docs/theory/fractal-beds.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.array_cache import keep_arrays
from insonify.kernels.common.streams import RELIEF_BAND
from insonify.parallel import PerThread
from insonify.scene.reliefs.spectrum import Band, Density
from insonify.terrain.lattice_noise import lattice_noise

Field = NDArray[np.float64]
ComplexField = NDArray[np.complex128]

TILE = 512  # nodes along a side of a tile, on every lattice
PART = 128  # nodes along a side of the smallest part of a tile that is kept
TAPS = 128  # along a side of the filter of a band
HIGHEST = 0.75  # share of its Nyquist frequency that the waves of an interpolated lattice reach
FEATURE = 6.0  # frequency steps of the coarsest filter across the finest feature of the density
KEPT = np.float32  # precision of filters and lattices that are kept; heights have no more in the end
FAINT = 1e-9  # share of the variance that may be neglected
HALF_BAND = 12  # pairs of taps of the half-band filter
KAISER = 9.0  # shape of its window: images are 90 dB down


class EndlessField:
    """A Gaussian field of a given spectrum over the whole plane.

    Parameters
    ----------
    bands : tuple of Band
        Parts of the spectrum, which add.
    spacing : float
        Metres between nodes. Fields on lattices of half the spacing share all but the finest waves.
    seed, stream : int
        Seed and stream of the hash.
    """

    def __init__(self, bands: tuple[Band, ...], spacing: float, seed: int, stream: int) -> None:
        nyquist = 0.5 / spacing
        room = min((nyquist - band.highest) / nyquist for band in bands)
        # A pyramid reaches to 0.75 of the Nyquist frequency of its first lattice; moved, it stays within the finest's.
        self._first = max(1, math.ceil(math.log2(HIGHEST / room)))
        self._spacing, self._bands = spacing, bands
        self._top = _Lattice(_Filter(self._above, spacing, TAPS << (self._first - 1)), seed, stream)
        self._moved = [
            tuple(_Pyramid(filters, seed, stream + RELIEF_BAND * (2 * k + 1 + part)) for part in parts)
            for k, band in enumerate(bands)
            for filters in [_band_filters(band, spacing, self._first)]
            for parts in [(0,) if band.wave is None else (0, 1)]
        ]

    @cached_property
    def variance(self) -> float:
        """Expected variance of the field on its nodes."""
        return self._top.variance + sum(pyramids[0].variance for pyramids in self._moved)

    def tile(self, row: int, column: int) -> Field:
        """Values on one tile.

        Parameters
        ----------
        row, column : int
            The nodes of the tile are (row · TILE + j, column · TILE + i), node (0, 0) at the origin.

        Returns
        -------
        (TILE, TILE) float64
        """
        total = self.complex_tile(row, column).real
        if self._top.variance > FAINT * self.variance:
            total = total + self._top.tile(row, column)
        return total

    def complex_tile(self, row: int, column: int) -> ComplexField:
        """Analytic signal on one tile (imaginary part: Hilbert transform), without the part of the finest lattice."""
        total = np.zeros((TILE, TILE), dtype=np.complex128)
        for band, pyramids in zip(self._bands, self._moved):
            if pyramids[0].variance <= FAINT * self.variance:
                continue
            if band.wave is None:
                total += pyramids[0].doubled(row, column)
                continue
            real, imaginary = (pyramid.doubled(row, column) for pyramid in pyramids)
            total += (real + 1j * imaginary) * self._carrier(band.wave, row, column)
        return total

    def _carrier(self, wave: tuple[float, float], row: int, column: int) -> ComplexField:
        nodes = np.arange(TILE)
        x, y = (self._spacing * (place * TILE + nodes) for place in (column, row))
        return np.asarray(np.exp(2j * math.pi * wave[1] * y)[:, np.newaxis] * np.exp(2j * math.pi * wave[0] * x))

    def _above(self, fx: Field, fy: Field) -> Field:
        """Density of the part that is made on the finest lattice."""
        total = np.zeros(np.broadcast_shapes(fx.shape, fy.shape))
        for band in self._bands:
            for sign in (0.0,) if band.wave is None else (1.0, -1.0):
                x, y = (0.0, 0.0) if band.wave is None else band.wave
                gx, gy = fx - sign * x, fy - sign * y
                total += band.density(gx, gy) * _above(np.hypot(gx, gy), _crossing(self._spacing, self._first - 1))
        return total


class _Pyramid:
    """Lattices of one band, each of twice the spacing of the one before, summed by interpolation."""

    def __init__(self, filters: dict[int, _Filter], seed: int, stream: int) -> None:
        lattices = {level: _Lattice(kernel, seed, stream) for level, kernel in filters.items()}
        self._lattices, self._first, self._last = lattices, min(lattices), max(lattices)
        self._part = keep_arrays(lambda level, side, row, column: lattices[level].part(side, row, column))

    @cached_property
    def variance(self) -> float:
        """Expected variance."""
        return sum(lattice.variance for lattice in self._lattices.values())

    def doubled(self, row: int, column: int) -> Field:
        """Tile of the whole pyramid, interpolated onto the finest lattice."""
        return self._from_coarser(0, (row * TILE, column * TILE), (TILE, TILE))

    def _region(self, level: int, first: tuple[int, int], shape: tuple[int, int]) -> Field:
        """Sum of the lattices from a level on, on a rectangle of nodes of that level."""
        lattice = self._lattices.get(level)
        if lattice is None or lattice.variance <= FAINT * self.variance:
            own = np.zeros(shape)
        else:
            side = _side_of_parts(level - self._first)
            parts = gather_tiles(lambda row, column: self._part(level, side, row, column), first, shape, side)
            own = parts.astype(np.float64)
        return own + self._from_coarser(level, first, shape) if level < self._last else own

    def _from_coarser(self, level: int, first: tuple[int, int], shape: tuple[int, int]) -> Field:
        """Sum of the lattices coarser than a level, interpolated onto a rectangle of its nodes."""
        low = tuple(place // 2 for place in first)
        nodes = tuple((place + count + 1) // 2 - begin for place, count, begin in zip(first, shape, low))
        around = self._region(
            level + 1, (low[0] - HALF_BAND, low[1] - HALF_BAND), (nodes[0] + 2 * HALF_BAND, nodes[1] + 2 * HALF_BAND)
        )
        fine = _interpolate(np.ascontiguousarray(_interpolate(around).T)).T
        row, column = (place % 2 for place in first)
        return fine[row : row + shape[0], column : column + shape[1]]


class _Filter:
    """Filter that gives white noise on one lattice a density."""

    def __init__(self, density: Density, spacing: float, taps: int) -> None:
        self.spacing, self.taps = spacing, taps
        fx = np.asarray(np.fft.rfftfreq(taps, spacing), np.float64)[np.newaxis, :]
        fy = np.asarray(np.fft.fftfreq(taps, spacing), np.float64)[:, np.newaxis]
        # Noise of unit variance has the density spacing².
        response = np.sqrt(density(fx, fy)) / spacing
        self._kernel = np.fft.irfft2(response, s=(taps, taps))
        # Taps half a side away have no counterpart on the other side.
        self._kernel[taps // 2], self._kernel[:, taps // 2] = 0.0, 0.0
        self.variance = float((self._kernel**2).sum())

    @property
    def transfer(self) -> NDArray[np.floating]:
        """Transform of the filter over one block; real, because the filter is even."""
        return _kept_transfer(self)

    def make_transfer(self) -> NDArray[np.floating]:
        """Transform the filter, as `transfer` keeps it."""
        half = self.taps // 2
        block = np.zeros((TILE + self.taps,) * 2)
        block[: self.taps, : self.taps] = np.roll(self._kernel, (half, half), axis=(0, 1))
        return np.fft.rfft2(np.roll(block, (-half, -half), axis=(0, 1))).real.astype(KEPT)


_kept_transfer = keep_arrays(_Filter.make_transfer)


# Numbers of a block and its transform, which a thread uses again: to lay out fresh memory takes as long as the filter.
_blocks = PerThread(
    lambda: lru_cache(maxsize=1)(lambda side: (np.empty((side, side)), np.empty((side, side // 2 + 1), np.complex128)))
)


class _Lattice:
    """Filtered white noise on one lattice."""

    def __init__(self, kernel: _Filter, seed: int, stream: int) -> None:
        self._filter, self._seed, self._stream = kernel, seed, stream
        self.variance = kernel.variance

    def tile(self, row: int, column: int) -> Field:
        """Filter the noise of one tile by overlap-save: the margin that wraps around is discarded."""
        side, margin = TILE + self._filter.taps, self._filter.taps // 2
        rows, columns = (range(place * TILE - margin, place * TILE - margin + side) for place in (row, column))
        block, waves = _blocks.own(side)
        lattice_noise(self._seed, self._stream, self._filter.spacing, rows, columns, block)
        np.fft.rfft2(block, out=waves)
        waves *= self._filter.transfer
        np.fft.ifft(waves, axis=0, out=waves)
        np.fft.irfft(waves, n=side, axis=1, out=block)
        return block[margin:-margin, margin:-margin].copy()

    def part(self, side: int, row: int, column: int) -> NDArray[np.floating]:
        """Square of some nodes a side, as many as divide a tile, as it is kept."""
        (tile_row, j), (tile_column, i) = divmod(row * side, TILE), divmod(column * side, TILE)
        return self.tile(tile_row, tile_column)[j : j + side, i : i + side].astype(KEPT)


def _band_filters(band: Band, spacing: float, first: int) -> dict[int, _Filter]:
    """Make the filters of a band, by the level of their lattice; level 0 is the finest lattice of all."""
    last = max(first, math.ceil(math.log2(FEATURE / (TAPS * spacing * band.feature))))
    # Two fields make one modulated band; each holds half of the waves of either sign of frequency.
    share = 1.0 if band.wave is None else 2.0

    def density(level: int) -> Density:
        low = 0.0 if level == last else _crossing(spacing, level)
        return _between(band.density, share, low, _crossing(spacing, level - 1))

    return {level: _Filter(density(level), spacing * 2.0**level, TAPS) for level in range(first, last + 1)}


def _side_of_parts(coarser: int) -> int:
    """Nodes along a side of the parts that are kept of a lattice, by the lattices of its pyramid that are finer.

    A window takes few nodes of a coarse lattice, about the corner of four tiles as a rule, but most of a fine one.
    """
    return max(min(TILE, 2 * TILE >> coarser), PART)


def gather_tiles(
    tile: Callable[[int, int], NDArray[Any]], first: tuple[int, int], shape: tuple[int, int], side: int = TILE
) -> NDArray[Any]:
    """Rectangle of nodes assembled from tiles.

    Parameters
    ----------
    tile : callable
        Tile of a row and a column.
    first : (int, int)
        Lowest node along y and x.
    shape : (ny, nx)
        Nodes.
    side : int
        Nodes along a side of a tile.

    Returns
    -------
    (ny, nx) array
        Values of the nodes, in the data type of the tiles.
    """
    rows, columns = (_pieces(low, count, side) for low, count in zip(first, shape))
    whole = np.empty(shape, dtype=tile(rows[0].tile, columns[0].tile).dtype)
    for row in rows:
        for column in columns:
            whole[row.whole, column.whole] = tile(row.tile, column.tile)[row.part, column.part]
    return whole


class _Piece(NamedTuple):
    """Contiguous run of nodes along one axis that lie in one tile."""

    tile: int
    part: slice  # nodes within the tile
    whole: slice  # nodes within the requested row


def _pieces(first: int, count: int, side: int) -> list[_Piece]:
    """Split a row of nodes at the borders of tiles."""
    tiles = range(first // side, (first + count - 1) // side + 1)
    runs = [(k, max(first, k * side), min(first + count, (k + 1) * side)) for k in tiles]
    return [
        _Piece(k, slice(low - k * side, high - k * side), slice(low - first, high - first)) for k, low, high in runs
    ]


def _interpolate(coarse: Field) -> Field:
    """Field of half the spacing along the first axis; `HALF_BAND` nodes at either end are used up."""
    count = len(coarse) - 2 * HALF_BAND
    fine = np.empty((2 * count, coarse.shape[1]))
    fine[0::2] = coarse[HALF_BAND : HALF_BAND + count]
    between = np.zeros((count, coarse.shape[1]))
    pair = np.empty_like(between)
    for k, tap in enumerate(_half_band()):
        before, after = HALF_BAND - k, HALF_BAND + 1 + k
        np.add(coarse[before : before + count], coarse[after : after + count], out=pair)
        pair *= tap
        between += pair
    fine[1::2] = between
    return fine


@lru_cache(maxsize=1)
def _half_band() -> tuple[float, ...]:
    """Taps of the half-band filter from the middle outwards: a sinc with a Kaiser window, of unit sum."""
    place = np.arange(HALF_BAND) + 0.5
    taps = np.sinc(place) * np.i0(KAISER * np.sqrt(1.0 - (place / HALF_BAND) ** 2))
    return tuple(float(tap) for tap in taps / (2.0 * taps.sum()))


def _crossing(spacing: float, level: int) -> float:
    """Lower end of the octave over which waves pass from the lattice of the next level to that of this level."""
    return 0.5 * HIGHEST * 0.5 / (spacing * 2.0 ** (level + 1))


def _above(frequency: Field, crossing: float) -> Field:
    """Share of the power above a crossing."""
    octave = np.log2(np.maximum(frequency, 1e-300) / crossing)
    return np.asarray(np.sin(0.5 * math.pi * np.clip(octave, 0.0, 1.0)) ** 2)


def _between(density: Density, share: float, low: float, high: float) -> Density:
    """Part of a density between two crossings, or below the higher where the lower is 0."""

    def band(fx: Field, fy: Field) -> Field:
        frequency = np.hypot(fx, fy)
        part = share * density(fx, fy) * (1.0 - _above(frequency, high))
        return np.asarray(part * _above(frequency, low) if low > 0.0 else part)

    return band
