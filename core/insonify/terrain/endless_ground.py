"""Endless ground: tiles and windows computed on demand, or one rectangle at once."""

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from insonify.array_cache import ARRAYS, keep_arrays
from insonify.arrays import Bytes, Floats, Integers, Singles
from insonify.parallel import in_parallel
from insonify.scene.seabed.materials.catalogue import Reflectivity
from insonify.terrain.endless_field import FAST, TILE, Nodes, Piece, split_nodes
from insonify.terrain.ground import Ground, bilinear, resolves_cells

Corner = tuple[float, float]
Tiles = Callable[[int, int], NDArray[Any]]
_Places = Integers

FARTHEST_TILE = 2**31  # tiles along an axis, farther than any tow
SQUARE = 64  # nodes along a side of a square; a tile contains a whole number of squares
KEPT_THINNED = 6  # heights, squares and materials of two thinned grounds


class StoredWindow(NamedTuple):
    """Heights and materials of a window of endless ground that is already computed; they are not written to."""

    row: int  # as numbered by `EndlessGround.cell`
    column: int
    heights: Singles  # (n, n) as `EndlessGround.window` returns them for the same reach
    materials: Bytes  # (n, n)


@dataclass(frozen=True, eq=False)
class EndlessGround:
    """Heights and materials of a bed without period or end."""

    # Functions of the row and column of a tile, which return (TILE, TILE) float32 and uint8. Node (0, 0) is at the
    # local origin.
    heights: Tiles
    materials: Tiles
    # Function of the row and column of a square, which returns (SQUARE, SQUARE) float32 heights, in a tenth of the
    # time of a tile. They differ from those of tiles by rounding.
    squares: Tiles
    names: tuple[str, ...]  # names of the materials
    reflectivities: tuple[Reflectivity, ...]  # scattering parameters of the materials
    spacing: float  # metres between nodes
    datum: float  # world height of the mean bed, in metres

    @property
    def same_windows(self) -> Hashable:
        """Key that two grounds share if their windows have the same bed."""
        return self.heights, self.materials, self.spacing, len(self.reflectivities)

    def cell(self, x: Floats, y: Floats) -> Integers:
        """Row and column of the window that contains each point, (n, 2)."""
        side = TILE * self.spacing
        return np.stack([np.floor(y / side), np.floor(x / side)], axis=-1).astype(np.int64)

    def window(self, row: int, column: int, reach: float, stored: StoredWindow | None = None) -> Ground:
        """Ground of one window and its surroundings up to a reach (m), with nodes copied from a stored window."""
        # Its arrays are periodic: a node is at its own row and column modulo their side.
        margin = math.ceil(reach / self.spacing) + 2
        side = TILE + 2 * margin + 1
        first = row * TILE - margin, column * TILE - margin
        known = None if stored is None else (stored.row * TILE - margin, stored.column * TILE - margin)
        heights = np.empty((side, side), np.float32) if stored is None else stored.heights.copy()
        materials = np.empty((side, side), np.uint8) if stored is None else stored.materials.copy()
        _complete(heights, self.heights, first, known)
        _complete(materials, self.materials, first, known)
        return self.part(heights, materials, 0.0, 0.0, periodic=True)

    def part(self, heights: Singles, materials: Bytes, x0: float, y0: float, *, periodic: bool) -> Ground:
        """Ground with given arrays of heights and materials, and the other properties of this one."""
        return Ground(heights, materials, self.names, self.reflectivities, x0, y0, self.spacing, periodic, self.datum)

    def around(self, centre: tuple[float, float], half: float) -> Ground:
        """Ground of a square around a point, stored as in `window`."""
        (cell,) = self.cell(np.array(centre[:1]), np.array(centre[1:]))
        return self.window(int(cell[0]), int(cell[1]), half)

    def thinned(self, every: int) -> Self:
        """Return the bed thinned to every n-th node along each axis, with node (0, 0)."""
        if every == 1:
            return self
        heights, materials, squares = (_thinned(tiles, every) for tiles in (self.heights, self.materials, self.squares))
        return replace(self, heights=heights, materials=materials, squares=squares, spacing=every * self.spacing)

    def height_at(self, x: Floats, y: Floats) -> Floats:
        """Bilinear height above the datum, NaN where float64 cannot resolve cells."""
        return self._interpolated(x, y, lambda j, i: _gathered(j, i, TILE, lambda tile: self.heights(*tile)))

    def height_at_once(self, x: Floats, y: Floats) -> Floats:
        """Bilinear height as in `height_at`, but from squares, which are faster, where the tile is not cached."""
        return self._interpolated(x, y, self._at_once)

    height_near = height_at  # because there is ground everywhere

    def _interpolated(self, x: Floats, y: Floats, at: Callable[[_Places, _Places], Floats]) -> Floats:
        """Bilinear interpolation of the heights that a function of rows and columns of nodes returns."""
        u, v = np.asarray(x, dtype=np.float64) / self.spacing, np.asarray(y, dtype=np.float64) / self.spacing
        resolved = resolves_cells(u, v)
        u, v = np.where(resolved, u, 0.0), np.where(resolved, v, 0.0)
        i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
        return np.where(resolved, bilinear(lambda k, m: at(j + k, i + m), u - i, v - j), np.nan)

    def _at_once(self, row: _Places, column: _Places) -> Floats:
        """Heights of nodes, from squares where the tile is not cached."""
        heights = _gathered(row, column, TILE, lambda tile: ARRAYS.find(self.heights, *tile))
        missing = np.isnan(heights)
        heights[missing] = _gathered(row[missing], column[missing], SQUARE, lambda square: self.squares(*square))
        return heights


@dataclass(frozen=True, eq=False)
class EndlessExcerpt(EndlessGround):
    """Endless ground with one rectangle computed at once instead of tile by tile.

    A window of tiles has several times the nodes that a few hundred pings need, which pays only for a longer tow.
    """

    make: Callable[[Nodes], Ground]  # function of some nodes that returns their ground, without ground outside
    rectangle: Ground  # over which all pings are traced, whatever their window

    @property
    def same_windows(self) -> Hashable:
        """Key of the bed: the rectangle."""
        return self.rectangle

    def cell(self, x: Floats, y: Floats) -> Integers:
        """Row and column of the only window, (n, 2)."""
        return np.zeros((np.size(x), 2), np.int64)

    def window(self, row: int, column: int, reach: float, stored: StoredWindow | None = None) -> Ground:
        """Return the rectangle for any window."""
        return self.rectangle

    def around(self, centre: Corner, half: float) -> Ground:
        """Ground of a square around a point: the rectangle, or another one if that does not contain the square."""
        low, high = ((centre[0] + sign * half, centre[1] + sign * half) for sign in (-1.0, 1.0))
        corners = (np.array(axis) for axis in zip(low, high))
        if np.isnan(self.rectangle.height_at(*corners)).any():
            return self.make(nodes_between(low, high, self.spacing))
        return self.rectangle

    def thinned(self, every: int) -> Self:
        """Return the bed thinned to every n-th node along each axis, with node (0, 0)."""
        thin = super().thinned(every)

        def make(nodes: Nodes) -> Ground:
            return self.make(Nodes(*(every * number for number in nodes))).thinned(every)

        return replace(thin, make=make, rectangle=self.rectangle.thinned(every))

    def height_at(self, x: Floats, y: Floats) -> Floats:
        """Bilinear height above the datum; from tiles outside the rectangle."""
        return self._completed(x, y, super().height_at)

    def height_at_once(self, x: Floats, y: Floats) -> Floats:
        """Bilinear height as in `height_at`; from squares outside the rectangle."""
        return self._completed(x, y, super().height_at_once)

    def _completed(self, x: Floats, y: Floats, outside: Callable[[Floats, Floats], Floats]) -> Floats:
        heights = self.rectangle.height_at(x, y)
        missing = np.isnan(heights)
        if missing.any():
            heights[missing] = outside(np.asarray(x)[missing], np.asarray(y)[missing])
        return heights

    def height_near(self, x: Floats, y: Floats) -> Floats:
        """Bilinear height above the datum; outside the rectangle the height of the nearest edge."""
        return self.rectangle.height_near(x, y)


AnyGround = Ground | EndlessGround


def _gathered(
    row: _Places, column: _Places, side: int, make: Callable[[tuple[int, int]], NDArray[Any] | None]
) -> Floats:
    """Values of nodes from squares of some nodes a side; NaN where there is no square."""
    values = np.full(row.shape, np.nan)
    down, across = row // side, column // side
    # One number a square: sorting rows of two takes ten times as long.
    number = down * FARTHEST_TILE + across
    for each in np.unique(number):
        here = number == each
        square = make((int(down[here][0]), int(across[here][0])))
        if square is not None:
            values[here] = square[row[here] % side, column[here] % side]
    return values


@lru_cache(maxsize=KEPT_THINNED)
def _thinned(tiles: Tiles, every: int) -> Tiles:
    """Tiles of every n-th node."""

    def tile(row: int, column: int) -> NDArray[Any]:
        # `every` divides TILE, so that each tile gives a square of whole nodes.
        parts = [
            [tiles(every * row + j, every * column + i)[::every, ::every] for i in range(every)] for j in range(every)
        ]
        return np.block(parts)

    return keep_arrays(tile)


def _complete(torus: NDArray[Any], tiles: Tiles, first: tuple[int, int], known: tuple[int, int] | None) -> None:
    """Write the nodes of a square, by its lowest, to an array in which each is at its indices modulo the side."""
    # Nodes of a known square of the same side are already there.
    side = len(torus)
    missing = [
        (down, across)
        for down in split_nodes(first[0], side, TILE)
        for across in split_nodes(first[1], side, TILE)
        if known is None or not (down.is_within(known[0], side) and across.is_within(known[1], side))
    ]
    # Neighbours together, because they share coarser lattices; lines along the shorter side first.
    outer = min((0, 1), key=lambda axis: len({pieces[axis].tile for pieces in missing}))
    for line in sorted({pieces[outer].tile for pieces in missing}):
        together = [pieces for pieces in missing if pieces[outer].tile == line]
        in_parallel(partial(_write_tiles, torus, tiles, together), len(together), least=1)


def _write_tiles(torus: NDArray[Any], tiles: Tiles, places: list[tuple[Piece, Piece]], first: int, last: int) -> None:
    """Write parts of some tiles to an array in which each node is at its indices modulo the side."""
    for down, across in places[first:last]:
        part = tiles(down.tile, across.tile)[down.part, across.part]
        for j in split_nodes(down.nodes.start, len(down.nodes), len(torus)):
            for i in split_nodes(across.nodes.start, len(across.nodes), len(torus)):
                torus[j.part, i.part] = part[j.whole, i.whole]


def nodes_between(low: Corner, high: Corner, spacing: float) -> Nodes:
    """Nodes around a rectangle; the first are multiples of `FAST`, so that thinned nodes are among them."""
    first = [math.floor(place / spacing / FAST) * FAST for place in low]
    counts = [math.ceil(place / spacing / FAST) * FAST + FAST - begin for place, begin in zip(high, first)]
    return Nodes(first[1], first[0], counts[1], counts[0])
