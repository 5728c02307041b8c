"""Endless ground, whose tiles and windows are computed on demand."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.array_cache import ARRAYS, keep_arrays
from insonify.parallel import in_parallel
from insonify.scene.materials import Reflectivity
from insonify.terrain.endless_field import TILE, gather_tiles
from insonify.terrain.ground import Ground, bilinear, tell_cells_apart

Column = NDArray[np.float64]
Tiles = Callable[[int, int], NDArray[Any]]

TILE_BYTES = 4 * TILE**2  # of heights
FARTHEST = 2**31  # tiles along an axis, farther than any tow
KEPT_THINNED = 4  # heights and materials of two grounds that are thinned


@dataclass(frozen=True, eq=False)
class EndlessGround:
    """Heights and materials of a bed without period or end.

    Attributes
    ----------
    heights, materials : callable
        Functions of the row and column of a tile, which return (TILE, TILE) float32 and uint8. Node (0, 0) lies at the
        local origin.
    names : tuple of str
        Names of the materials.
    reflectivities : tuple of Reflectivity
        Scattering parameters of the materials.
    spacing : float
        Metres between nodes.
    datum : float
        World height of the mean bed, in metres.
    """

    heights: Tiles
    materials: Tiles
    names: tuple[str, ...]
    reflectivities: tuple[Reflectivity, ...]
    spacing: float
    datum: float

    def cell(self, x: Column, y: Column) -> NDArray[np.int64]:
        """Row and column of the window that holds each place, (n, 2)."""
        side = TILE * self.spacing
        return np.stack([np.floor(y / side), np.floor(x / side)], axis=-1).astype(np.int64)

    def window(self, row: int, column: int, reach: float) -> Ground:
        """Ground of one window and its surroundings.

        Parameters
        ----------
        row, column : int
            Window, as numbered by `cell`.
        reach : float
            Metres of ground around the window.

        Returns
        -------
        Ground
            A torus: node (j, i) of the world is stored at (j mod ny, i mod nx), so that code which wraps indices finds
            every node within reach at its place in the world. Nodes beyond are not held.
        """
        margin = math.ceil(reach / self.spacing) + 2
        first, side = (row * TILE - margin, column * TILE - margin), TILE + 2 * margin + 1
        return Ground(
            heights=_torus(self.heights, first, side),
            materials=_torus(self.materials, first, side),
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
        heights, materials = (_thinned(tiles, every) for tiles in (self.heights, self.materials))
        return replace(self, heights=heights, materials=materials, spacing=every * self.spacing)

    def height_at(self, x: Column, y: Column) -> Column:
        """Bilinear height above the datum, NaN where a place is no number that tells cells apart.

        Parameters
        ----------
        x, y : float64 arrays
            Local coordinates in metres, of one shape.

        Returns
        -------
        float64 array
            Metres above the datum.
        """
        u, v = np.asarray(x, dtype=np.float64) / self.spacing, np.asarray(y, dtype=np.float64) / self.spacing
        known = tell_cells_apart(u, v)
        u, v = np.where(known, u, 0.0), np.where(known, v, 0.0)
        i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
        return np.where(known, bilinear(lambda k, m: self._at(j + k, i + m), u - i, v - j), np.nan)

    def height_near(self, x: Column, y: Column) -> Column:
        """Bilinear height above the datum as in `height_at`, because there is ground everywhere."""
        return self.height_at(x, y)

    def _at(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> Column:
        """Heights of nodes of the given rows and columns."""
        heights = np.empty(row.shape)
        tile_row, tile_column = row // TILE, column // TILE
        # One number a tile, because rows of two are sorted ten times as slowly.
        number = tile_row * FARTHEST + tile_column
        for each in np.unique(number):
            here = number == each
            tile = self.heights(int(tile_row[here][0]), int(tile_column[here][0]))
            heights[here] = tile[row[here] % TILE, column[here] % TILE]
        return heights


AnyGround = Ground | EndlessGround


@lru_cache(maxsize=KEPT_THINNED)
def _thinned(tiles: Tiles, every: int) -> Tiles:
    """Tiles of every n-th node."""
    side = every * TILE
    return keep_arrays(
        lambda row, column: gather_tiles(tiles, (row * side, column * side), (side, side))[::every, ::every]
    )


def _torus(tiles: Tiles, first: tuple[int, int], side: int) -> NDArray[Any]:
    """Square of nodes, each stored at its indices modulo the size of the square."""
    rows, columns = (range(low // TILE, (low + side - 1) // TILE + 1) for low in first)
    if len(rows) * len(columns) * TILE_BYTES <= ARRAYS.limit:  # else the first are dropped before they are gathered
        for row in rows:  # neighbours together: they share tiles of coarser lattices
            in_parallel(partial(_make_tiles, tiles, row, columns), len(columns), least=1)
    return np.roll(gather_tiles(tiles, first, (side, side)), (first[0] % side, first[1] % side), axis=(0, 1))


def _make_tiles(tiles: Tiles, row: int, columns: range, first: int, last: int) -> None:
    """Make some tiles of a row, which are kept."""
    for column in columns[first:last]:
        tiles(row, column)
