"""Pings by the window of ground that they are heard over."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.kernels.common.types import Bed, Poses, SceneArrays
from insonify.packing.scene_arrays import make_bed
from insonify.terrain import AnyGround, EndlessGround

Column = NDArray[Any]

# Bent sound may go farther in the time of a slant range than straight sound does.
MARGIN = 1.1
KEPT_BEDS = 2


class TerrainTiles:
    """Beds, one for each window of endless ground; any other ground is one window.

    Parameters
    ----------
    ground : AnyGround
        What is beneath.
    reach : float
        Slant range to which it is heard, in metres.
    """

    def __init__(self, ground: AnyGround, reach: float) -> None:
        self._ground, self.reach = ground, reach
        self._bed = lru_cache(maxsize=KEPT_BEDS)(self._made_bed)

    def over(self, arrays: SceneArrays, poses: Poses) -> Iterator[tuple[NDArray[np.int64] | slice, SceneArrays]]:
        """Sort poses by their windows.

        Parameters
        ----------
        arrays : SceneArrays
            A scene over this ground.
        poses : Poses
            Where the sonar is, n pings.

        Yields
        ------
        places : int64 array or slice
            Which of the poses.
        arrays : SceneArrays
            With the bed about them: a function of each pose alone.
        """
        if not isinstance(self._ground, EndlessGround) or poses.x.size == 0:
            yield slice(None), arrays
            return
        cells, which = np.unique(self._ground.cell(poses.x, poses.y), axis=0, return_inverse=True)
        for k, (row, column) in enumerate(cells):
            yield np.flatnonzero(which.reshape(-1) == k), arrays._replace(bed=self._bed(int(row), int(column)))

    def _made_bed(self, row: int, column: int) -> Bed:
        assert isinstance(self._ground, EndlessGround)
        return make_bed(self._ground.window(row, column, MARGIN * self.reach))


def restore_order(places: Sequence[NDArray[np.int64] | slice], columns: Sequence[Column]) -> Column:
    """Join what was found for pings window by window, in the order of the pings."""
    if len(columns) == 1:
        return columns[0]
    joined = np.concatenate(columns)
    ordered = np.empty_like(joined)
    ordered[np.concatenate([np.asarray(place) for place in places])] = joined
    return ordered
