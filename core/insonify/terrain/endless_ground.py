"""Endless ground, whose tiles and windows are computed on demand."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.array_cache import ARRAYS, keep_arrays
from insonify.parallel import in_parallel
from insonify.scene.seabed.materials import Reflectivity
from insonify.terrain.endless_field import TILE
from insonify.terrain.ground import Ground, bilinear, tell_cells_apart

Column = NDArray[np.float64]
Tiles = Callable[[int, int], NDArray[Any]]
_Places = NDArray[np.int64]

FARTHEST = 2**31  # tiles along an axis, farther than any tow
SQUARE = 64  # nodes along a side of a square, of which a tile holds a whole number
KEPT_THINNED = 6  # heights, squares and materials of two grounds that are thinned


class HeldWindow(NamedTuple):
    """Heights and materials of a window of endless ground, which are not written to."""

    row: int  # as numbered by `EndlessGround.cell`
    column: int
    heights: NDArray[np.float32]  # (n, n) as `EndlessGround.window` stores them, of one reach
    materials: NDArray[np.uint8]  # (n, n)


@dataclass(frozen=True, eq=False)
class EndlessGround:
    """Heights and materials of a bed without period or end."""

    # Functions of the row and column of a tile, which return (TILE, TILE) float32 and uint8. Node (0, 0) lies at
    # the local origin.
    heights: Tiles
    materials: Tiles
    # Function of the row and column of a square, which returns (SQUARE, SQUARE) float32 heights, in a tenth of a
    # tile's time. They differ from those of tiles by rounding.
    squares: Tiles
    names: tuple[str, ...]  # names of the materials
    reflectivities: tuple[Reflectivity, ...]  # scattering parameters of the materials
    spacing: float  # metres between nodes
    datum: float  # world height of the mean bed, in metres

    @property
    def same_windows(self) -> Hashable:
        """What two grounds have in common if their windows hold the same bed."""
        return self.heights, self.materials, self.spacing, len(self.reflectivities)

    def cell(self, x: Column, y: Column) -> NDArray[np.int64]:
        """Row and column of the window that holds each place, (n, 2)."""
        side = TILE * self.spacing
        return np.stack([np.floor(y / side), np.floor(x / side)], axis=-1).astype(np.int64)

    def window(self, row: int, column: int, reach: float, held: HeldWindow | None = None) -> Ground:
        """Ground of one window and its surroundings."""
        margin = math.ceil(reach / self.spacing) + 2
        side = TILE + 2 * margin + 1
        square = _Square(row * TILE - margin, column * TILE - margin, side)
        known = None if held is None else _Square(held.row * TILE - margin, held.column * TILE - margin, side)
        heights = np.empty((side, side), np.float32) if held is None else held.heights.copy()
        materials = np.empty((side, side), np.uint8) if held is None else held.materials.copy()
        _complete(heights, self.heights, square, known)
        _complete(materials, self.materials, square, known)
        return Ground(
            heights=heights,
            materials=materials,
            names=self.names,
            reflectivities=self.reflectivities,
            x0=0.0,
            y0=0.0,
            spacing=self.spacing,
            periodic=True,
            datum=self.datum,
        )

    def around(self, centre: tuple[float, float], half: float) -> Ground:
        """Ground of a square around a place, stored as in `window`."""
        (cell,) = self.cell(np.array(centre[:1]), np.array(centre[1:]))
        return self.window(int(cell[0]), int(cell[1]), half)

    def thinned(self, every: int) -> EndlessGround:
        """Return the bed thinned to every n-th node along each axis, with node (0, 0)."""
        if every == 1:
            return self
        heights, materials, squares = (_thinned(tiles, every) for tiles in (self.heights, self.materials, self.squares))
        return replace(self, heights=heights, materials=materials, squares=squares, spacing=every * self.spacing)

    def height_at(self, x: Column, y: Column) -> Column:
        """Bilinear height above the datum, NaN where a place is no number that tells cells apart."""
        return self._interpolated(x, y, self._at)

    def height_at_once(self, x: Column, y: Column) -> Column:
        """Bilinear height as in `height_at`, from squares where the tile is not cached: a tile takes too long."""
        return self._interpolated(x, y, self._at_once)

    def height_near(self, x: Column, y: Column) -> Column:
        """Bilinear height above the datum as in `height_at`, because there is ground everywhere."""
        return self.height_at(x, y)

    def _interpolated(self, x: Column, y: Column, at: Callable[[_Places, _Places], Column]) -> Column:
        """Bilinear height between the nodes whose heights a function of their rows and columns returns."""
        u, v = np.asarray(x, dtype=np.float64) / self.spacing, np.asarray(y, dtype=np.float64) / self.spacing
        known = tell_cells_apart(u, v)
        u, v = np.where(known, u, 0.0), np.where(known, v, 0.0)
        i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
        return np.where(known, bilinear(lambda k, m: at(j + k, i + m), u - i, v - j), np.nan)

    def _at(self, row: _Places, column: _Places) -> Column:
        """Heights of nodes of the given rows and columns."""
        return _gathered(row, column, TILE, lambda here: self.heights(*here))

    def _at_once(self, row: _Places, column: _Places) -> Column:
        """Heights of nodes, of squares where the tile is not kept."""
        heights = _gathered(row, column, TILE, lambda here: ARRAYS.find(self.heights, *here))
        missing = np.isnan(heights)
        heights[missing] = _gathered(row[missing], column[missing], SQUARE, lambda here: self.squares(*here))
        return heights


AnyGround = Ground | EndlessGround


def _gathered(
    row: _Places, column: _Places, side: int, make: Callable[[tuple[int, int]], NDArray[Any] | None]
) -> Column:
    """Values of nodes from the squares of some nodes a side that hold them; NaN where there is no square."""
    values = np.full(row.shape, np.nan)
    down, across = row // side, column // side
    # One number a square, because rows of two are sorted ten times as slowly.
    number = down * FARTHEST + across
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


class _Square(NamedTuple):
    """Square of nodes."""

    row: int  # its lowest node along y and x
    column: int
    side: int  # nodes along a side

    def part(self, row: int, column: int) -> tuple[range, range]:
        """Rows and columns of the nodes of a tile that are within the square."""
        return _within(row, self.row, self.side), _within(column, self.column, self.side)

    def holds(self, rows: range, columns: range) -> bool:
        """Whether some nodes are all within the square."""
        return all(
            low <= nodes.start and nodes.stop <= low + self.side
            for low, nodes in ((self.row, rows), (self.column, columns))
        )


def _complete(torus: NDArray[Any], tiles: Tiles, square: _Square, known: _Square | None) -> None:
    """Put the values of a square into an array that stores each node at its indices modulo the side of the square.

    Nodes of a known square of the same side are in it already.
    """
    missing = [
        (row, column)
        for row in _tiles_of(square.row, square.side)
        for column in _tiles_of(square.column, square.side)
        if known is None or not known.holds(*square.part(row, column))
    ]
    # Neighbours together, because they share coarser lattices, and across the shorter side first.
    outer = min((0, 1), key=lambda axis: len({tile[axis] for tile in missing}))
    for line in sorted({tile[outer] for tile in missing}):
        together = [tile for tile in missing if tile[outer] == line]
        in_parallel(partial(_put_tiles, torus, tiles, square, together), len(together), least=1)


def _put_tiles(
    torus: NDArray[Any], tiles: Tiles, square: _Square, places: list[tuple[int, int]], first: int, last: int
) -> None:
    """Put some of the tiles at given places into the array, as far as the square holds them."""
    for row, column in places[first:last]:
        tile, (rows, columns) = tiles(row, column), square.part(row, column)
        for j in _runs(rows, square.side):
            for i in _runs(columns, square.side):
                torus[_modulo(j, square.side), _modulo(i, square.side)] = tile[_modulo(j, TILE), _modulo(i, TILE)]


def _tiles_of(low: int, count: int) -> range:
    """Tiles along one axis of successive nodes."""
    return range(low // TILE, (low + count - 1) // TILE + 1)


def _within(tile: int, low: int, count: int) -> range:
    """Nodes of a tile along one axis that are among some successive nodes."""
    return range(max(tile * TILE, low), min((tile + 1) * TILE, low + count))


def _runs(nodes: range, side: int) -> list[range]:
    """Split nodes at the multiples of a side."""
    edges = [nodes.start, *range((nodes.start // side + 1) * side, nodes.stop, side), nodes.stop]
    return [range(low, high) for low, high in pairwise(edges)]


def _modulo(nodes: range, side: int) -> slice:
    """Places of a run of nodes modulo a side."""
    return slice(nodes.start % side, nodes.start % side + len(nodes))
