"""Endless Gaussian fields without period or seam; each tile is a function of its position.

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
from functools import cached_property, lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.array_cache import keep_arrays
from insonify.arrays import Complexes, Floats, Reals
from insonify.kernels.common.hashing import FIRST_MULTIPLIER, GOLDEN, SECOND_MULTIPLIER, SHIFTS, splitmix64
from insonify.kernels.common.streams import RELIEF_BAND
from insonify.parallel import PerThread
from insonify.scene.seabed.reliefs.spectrum import Band, Density

Bits = NDArray[np.uint64]
HALF = np.uint64(32)
LOW = np.uint64(0xFFFFFFFF)
UNIT = np.float32(2.0**-32)
TINY = np.float32(2.0**-33)  # keeps a logarithm finite
STRIP = 64  # rows at a time, which stay in the processor's cache
TILE = 512  # nodes along a side of a tile, on every lattice
PART = 128  # nodes along a side of the smallest cached part of a tile
FAST = 32  # nodes of which the side of a block is a multiple, for fast transforms
TAPS = 128  # along a side of the filter of a band
HIGHEST = 0.75  # share of its Nyquist frequency that the waves of an interpolated lattice reach
FEATURE = 6.0  # frequency steps of the coarsest filter across the finest feature of the density
KEPT = np.float32  # precision of cached filters and lattices, that of heights in the end
FAINT = 1e-9  # share of the variance that is neglected
HALF_BAND = 12  # pairs of taps of the half-band filter
KAISER = 9.0  # shape of its window: images are 90 dB down


def lattice_noise(
    seed: int, stream: int, spacing: float, rows: range, columns: range, out: Floats | None = None
) -> Floats:
    """White Gaussian noise of unit variance on a rectangle of an endless lattice."""
    key = splitmix64(splitmix64(splitmix64(np.uint64(seed)) ^ np.uint64(stream)) ^ np.float64(spacing).view(np.uint64))
    keys = _mixed(np.uint64(key) ^ np.array(rows, dtype=np.int64).view(np.uint64))
    # One hash gives the two numbers of a pair of neighbours (Box and Muller 1958). Their 24 bits suffice, because
    # filters sum many of them.
    pairs = np.arange(columns.start // 2, columns.stop // 2, dtype=np.int64).view(np.uint64)
    noise = np.empty((len(rows), len(columns))) if out is None else out
    for first in range(0, len(keys), STRIP):
        _draw(keys[first : first + STRIP], pairs, noise[first : first + STRIP])
    return noise


def _draw(keys: Bits, pairs: Bits, noise: Floats) -> None:
    """Set some rows of noise from the keys of the rows and the numbers of the pairs."""
    bits = _mixed(keys[:, np.newaxis] ^ pairs)
    modulus = np.sqrt(np.float32(-2.0) * np.log((bits >> HALF).astype(np.float32) * UNIT + TINY))
    angle = (bits & LOW).astype(np.float32) * (np.float32(2.0 * math.pi) * UNIT)
    np.multiply(modulus, np.cos(angle), out=noise[:, 0::2])
    np.multiply(modulus, np.sin(angle), out=noise[:, 1::2])


def _mixed(value: Bits) -> Bits:
    """Apply splitmix64, as in `insonify.kernels.common.hashing`, to an array."""
    mixed = value + GOLDEN
    mixed = (mixed ^ (mixed >> SHIFTS[0])) * FIRST_MULTIPLIER
    mixed = (mixed ^ (mixed >> SHIFTS[1])) * SECOND_MULTIPLIER
    return np.asarray(mixed ^ (mixed >> SHIFTS[2]))


class Nodes(NamedTuple):
    """Rectangle of nodes of a lattice."""

    row: int  # its lowest node along y and x; node (0, 0) lies at the origin
    column: int
    rows: int  # number of nodes along either axis
    columns: int

    @classmethod
    def of_tile(cls, row: int, column: int) -> Nodes:
        """Nodes of one tile."""
        return cls(row * TILE, column * TILE, TILE, TILE)

    @property
    def first(self) -> tuple[int, int]:
        """Lowest node."""
        return self.row, self.column

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of nodes."""
        return self.rows, self.columns

    @property
    def is_tile(self) -> bool:
        """Whether they belong to a tile."""
        return self.shape == (TILE, TILE) and self.row % TILE == self.column % TILE == 0


class EndlessField:
    """A Gaussian field of a given spectrum over the whole plane.

    Parts of the lattices of a tile are cached for its neighbours; any other rectangle is computed alone.
    """

    def __init__(self, bands: tuple[Band, ...], spacing: float, seed: int, stream: int) -> None:
        nyquist = 0.5 / spacing
        room = min((nyquist - band.highest) / nyquist for band in bands)
        # A pyramid reaches 0.75 of the Nyquist frequency of its first lattice; modulated, it stays within the finest's.
        self._first = max(1, math.ceil(math.log2(HIGHEST / room)))
        self._spacing, self._bands = spacing, bands
        self._top = _Lattice(_Filter(self._above, spacing, TAPS << (self._first - 1)), seed, stream)
        self._modulated = [
            tuple(_Pyramid(filters, seed, stream + RELIEF_BAND * (2 * k + 1 + part)) for part in parts)
            for k, band in enumerate(bands)
            for filters in [_band_filters(band, spacing, self._first)]
            for parts in [(0,) if band.wave is None else (0, 1)]
        ]

    @cached_property
    def variance(self) -> float:
        """Expected variance of the field on its nodes."""
        return self._top.variance + sum(pyramids[0].variance for pyramids in self._modulated)

    def values(self, nodes: Nodes) -> Floats:
        """Values on some nodes."""
        total = self.complex_values(nodes).real
        if self._top.variance > FAINT * self.variance:
            total = total + self._top.values(nodes)
        return total

    def complex_values(self, nodes: Nodes) -> Complexes:
        """Analytic signal on some nodes (imaginary part: Hilbert transform), without the finest lattice."""
        total = np.zeros(nodes.shape, dtype=np.complex128)
        for band, pyramids in zip(self._bands, self._modulated):
            if pyramids[0].variance <= FAINT * self.variance:
                continue
            if band.wave is None:
                total += pyramids[0].doubled(nodes)
                continue
            real, imaginary = (pyramid.doubled(nodes) for pyramid in pyramids)
            y, x = (self._spacing * (first + np.arange(count)) for first, count in zip(nodes.first, nodes.shape))
            along, across = np.exp(2j * math.pi * band.wave[1] * y), np.exp(2j * math.pi * band.wave[0] * x)
            total += (real + 1j * imaginary) * (along[:, np.newaxis] * across)
        return total

    def _above(self, fx: Floats, fy: Floats) -> Floats:
        """Density of the part on the finest lattice."""
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

    def doubled(self, nodes: Nodes) -> Floats:
        """Values of the whole pyramid, interpolated onto nodes of the finest lattice."""
        return self._from_coarser(0, nodes, keep=nodes.is_tile)

    def _region(self, level: int, nodes: Nodes, *, keep: bool) -> Floats:
        """Sum of the lattices from a level on, on nodes of that level."""
        lattice = self._lattices.get(level)
        if lattice is None or lattice.variance <= FAINT * self.variance:
            own = np.zeros(nodes.shape)
        elif keep:
            # A window needs few nodes of a coarse lattice, usually around the corner of four tiles, but most of a fine
            # one.
            side = max(min(TILE, 2 * TILE >> level - self._first), PART)
            parts = gather_tiles(
                lambda row, column: self._part(level, side, row, column), nodes.first, nodes.shape, side
            )
            own = parts.astype(np.float64)
        else:
            own = lattice.values(nodes)
        return own + self._from_coarser(level, nodes, keep=keep) if level < self._last else own

    def _from_coarser(self, level: int, nodes: Nodes, *, keep: bool) -> Floats:
        """Sum of the lattices coarser than a level, interpolated onto its nodes."""
        low = tuple(place // 2 for place in nodes.first)
        counts = tuple((place + count + 1) // 2 - begin for place, count, begin in zip(nodes.first, nodes.shape, low))
        wider = Nodes(*(begin - HALF_BAND for begin in low), *(count + 2 * HALF_BAND for count in counts))
        around = self._region(level + 1, wider, keep=keep)
        fine = _interpolate(np.ascontiguousarray(_interpolate(around).T)).T
        row, column = (place % 2 for place in nodes.first)
        return fine[row : row + nodes.rows, column : column + nodes.columns]


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

    def transfer(self, shape: tuple[int, int]) -> Reals:
        """Transform of the filter over a block of nodes and the taps around them; real because the filter is even."""
        half = self.taps // 2
        block = np.zeros((shape[0] + self.taps, shape[1] + self.taps))
        block[: self.taps, : self.taps] = np.roll(self._kernel, (half, half), axis=(0, 1))
        return np.fft.rfft2(np.roll(block, (-half, -half), axis=(0, 1))).real.astype(KEPT)


@keep_arrays
def _kept_transfer(kernel: _Filter) -> Reals:
    return kernel.transfer((TILE, TILE))


# A block and its transform, which a thread reuses: allocating memory takes as long as the filter.
_blocks = PerThread(
    lambda: lru_cache(maxsize=1)(lambda ny, nx: (np.empty((ny, nx)), np.empty((ny, nx // 2 + 1), np.complex128)))
)


class _Lattice:
    """Filtered white noise on one lattice."""

    def __init__(self, kernel: _Filter, seed: int, stream: int) -> None:
        self._filter, self._seed, self._stream = kernel, seed, stream
        self.variance = kernel.variance

    def values(self, nodes: Nodes) -> Floats:
        """Filter the noise of some nodes by overlap-save, without the margin that wraps around."""
        if nodes.is_tile:
            return self._filtered(nodes, _kept_transfer(self._filter))
        # Blocks with sides that are fast to transform, from an even column on because noise is drawn in pairs.
        lead = nodes.column % 2
        rows, columns = (-(-count // FAST) * FAST for count in (nodes.rows, nodes.columns + lead))
        wider = Nodes(nodes.row, nodes.column - lead, rows, columns)
        return self._filtered(wider, self._filter.transfer(wider.shape))[: nodes.rows, lead : lead + nodes.columns]

    def part(self, side: int, row: int, column: int) -> Reals:
        """Square of some nodes a side (a divisor of `TILE`), in the precision of the cache."""
        (tile_row, j), (tile_column, i) = divmod(row * side, TILE), divmod(column * side, TILE)
        tile = self.values(Nodes.of_tile(tile_row, tile_column))
        return tile[j : j + side, i : i + side].astype(KEPT)

    def _filtered(self, nodes: Nodes, transfer: Reals) -> Floats:
        taps, margin = self._filter.taps, self._filter.taps // 2
        sides = tuple(count + taps for count in nodes.shape)
        rows, columns = (range(first - margin, first - margin + side) for first, side in zip(nodes.first, sides))
        block, waves = _blocks.own(*sides)
        lattice_noise(self._seed, self._stream, self._filter.spacing, rows, columns, block)
        np.fft.rfft2(block, out=waves)
        waves *= transfer
        np.fft.ifft(waves, axis=0, out=waves)
        np.fft.irfft(waves, n=sides[1], axis=1, out=block)
        return block[margin:-margin, margin:-margin].copy()


def _band_filters(band: Band, spacing: float, first: int) -> dict[int, _Filter]:
    """Compute the filters of a band, by the level of their lattice; level 0 is the finest."""
    last = max(first, math.ceil(math.log2(FEATURE / (TAPS * spacing * band.feature))))
    # A modulated band consists of two fields, each with half of the waves of either sign of frequency.
    share = 1.0 if band.wave is None else 2.0

    def density(level: int, fx: Floats, fy: Floats) -> Floats:
        """Part of the density between two crossings, of the last level below one."""
        frequency = np.hypot(fx, fy)
        part = share * band.density(fx, fy) * (1.0 - _above(frequency, _crossing(spacing, level - 1)))
        return part if level == last else np.asarray(part * _above(frequency, _crossing(spacing, level)))

    return {level: _Filter(partial(density, level), spacing * 2.0**level, TAPS) for level in range(first, last + 1)}


def gather_tiles(
    tile: Callable[[int, int], NDArray[Any]], first: tuple[int, int], shape: tuple[int, int], side: int = TILE
) -> NDArray[Any]:
    """Rectangle of nodes assembled from tiles."""
    rows, columns = (split_nodes(low, count, side) for low, count in zip(first, shape))
    whole = np.empty(shape, dtype=tile(rows[0].tile, columns[0].tile).dtype)
    for row in rows:
        for column in columns:
            whole[row.whole, column.whole] = tile(row.tile, column.tile)[row.part, column.part]
    return whole


class Piece(NamedTuple):
    """Successive nodes along one axis within one tile."""

    tile: int
    nodes: range
    part: slice  # the nodes within the tile
    whole: slice  # the nodes within all that were split

    def is_within(self, first: int, count: int) -> bool:
        """Whether all of them are among successive nodes."""
        return first <= self.nodes.start and self.nodes.stop <= first + count


def split_nodes(first: int, count: int, side: int) -> list[Piece]:
    """Split successive nodes along one axis at the borders of tiles."""
    tiles = range(first // side, (first + count - 1) // side + 1)
    runs = [(k, max(first, k * side), min(first + count, (k + 1) * side)) for k in tiles]
    return [
        Piece(k, range(low, high), slice(low - k * side, high - k * side), slice(low - first, high - first))
        for k, low, high in runs
    ]


def _interpolate(coarse: Floats) -> Floats:
    """Field of half the spacing along the first axis, without `HALF_BAND` nodes at either end."""
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
    """Lower end of the octave over which waves pass from the lattice of the next level to the lattice of this level."""
    return 0.5 * HIGHEST * 0.5 / (spacing * 2.0 ** (level + 1))


def _above(frequency: Floats, crossing: float) -> Floats:
    """Share of the power above a crossing."""
    octave = np.log2(np.maximum(frequency, 1e-300) / crossing)
    return np.asarray(np.sin(0.5 * math.pi * np.clip(octave, 0.0, 1.0)) ** 2)
