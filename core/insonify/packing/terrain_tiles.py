"""Tiles of endless ground, each wide enough for the pings over its middle."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from functools import lru_cache
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Bed, Poses, SceneArrays
from insonify.packing.navigation import take_poses
from insonify.packing.scene_arrays import make_bed
from insonify.terrain import AnyGround, EndlessGround

Column = NDArray[Any]
Beds = Callable[[int, int], Bed]

# Refracted rays may go farther in the time of a slant range than straight ones.
MARGIN = 1.1
KEPT_BEDS = 3
_SHARED: WeakValueDictionary[Hashable, Beds] = WeakValueDictionary()


class TerrainTiles:
    """Beds, one for each tile of endless ground; any other ground is one tile.

    Parameters
    ----------
    ground : AnyGround
        The bed.
    reach : float
        Greatest slant range of the record, in metres.
    """

    def __init__(self, ground: AnyGround, reach: float) -> None:
        self._ground, self.reach = ground, reach
        self._bed = _beds_of(ground, reach) if isinstance(ground, EndlessGround) else None

    def map(
        self, trace: Callable[[SceneArrays, Poses], tuple[Column, ...]], arrays: SceneArrays, poses: Poses
    ) -> tuple[Column, ...]:
        """Trace pings tile by tile.

        Parameters
        ----------
        trace : callable
            From the scene over one tile and the poses over it to arrays whose first axis is that of the pings.
        arrays : SceneArrays
            The scene, over any ground.
        poses : Poses
            Where the sonar is, n pings. The tile beneath each is a function of its pose alone.

        Returns
        -------
        tuple of (n, …) arrays
            In the order of the pings.
        """
        parts = ((some, trace(tile, take_poses(poses, some))) for some, tile in self.split(arrays, poses))
        places, found = zip(*parts)
        return tuple(_join(places, columns) for columns in zip(*found))

    def split(self, arrays: SceneArrays, poses: Poses) -> Iterator[tuple[NDArray[np.int64] | slice, SceneArrays]]:
        """Sort poses by the tiles beneath them.

        Parameters
        ----------
        arrays, poses
            As in `map`.

        Yields
        ------
        places : int64 array or slice
            Which of the poses.
        arrays : SceneArrays
            The scene over the tile beneath them.
        """
        if self._bed is None or poses.x.size == 0:
            yield slice(None), arrays
            return
        assert isinstance(self._ground, EndlessGround)
        cells, which = np.unique(self._ground.cell(poses.x, poses.y), axis=0, return_inverse=True)
        for k, (row, column) in enumerate(cells):
            yield np.flatnonzero(which.reshape(-1) == k), arrays._replace(bed=self._bed(int(row), int(column)))


def _beds_of(ground: EndlessGround, reach: float) -> Beds:
    """Beds of the windows of endless ground; scenes on the same ground share them while one of them lives."""
    key = ground.heights, ground.materials, ground.spacing, len(ground.reflectivities), reach
    if (known := _SHARED.get(key)) is not None:
        return known

    @lru_cache(maxsize=KEPT_BEDS)
    def make(row: int, column: int) -> Bed:
        return make_bed(ground.window(row, column, MARGIN * reach))

    _SHARED[key] = make
    return make


def _join(places: Sequence[NDArray[np.int64] | slice], columns: Sequence[Column]) -> Column:
    """Join the columns of several tiles in the order of the pings."""
    if len(columns) == 1:
        return columns[0]
    joined = np.concatenate(columns)
    ordered = np.empty_like(joined)
    ordered[np.concatenate([np.asarray(place) for place in places])] = joined
    return ordered
