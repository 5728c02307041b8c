"""Tiles of endless ground, each wide enough for the pings over its middle."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import count
from threading import Lock
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Integers
from insonify.kernels.common.types import Bed, Poses, SceneArrays
from insonify.packing.scene_arrays import make_bed
from insonify.terrain import AnyGround, EndlessGround, StoredWindow
from insonify.tow.poses import take_poses

Column = NDArray[Any]

# Refracted rays may go farther in the time of a slant range than straight ones.
REACH_MARGIN = 1.1
KEPT_BEDS, MOST_BEDS = 2, 6  # of pings that follow one another, and of a call over many windows; some 23 MB each
LARGEST = 2**28  # bytes of the beds of all grounds, though the newest of each call is kept whatever it takes
_SHARED: WeakValueDictionary[Hashable, _WindowBeds] = WeakValueDictionary()
_SHARING = Lock()
_TURNS = count(1)


class TerrainTiles:
    """Beds, one for each tile of endless ground; any other ground is one tile."""

    def __init__(self, ground: AnyGround, reach: float) -> None:
        self._beds = _beds_of(ground, reach) if isinstance(ground, EndlessGround) else None

    def expect(self, poses: Poses) -> None:
        """Keep the beds of all windows beneath some poses, up to `MOST_BEDS`, once they are made."""
        # Calls over one window after another otherwise drop the first beds, which a later call over all of them needs.
        if self._beds is not None and poses.x.size:
            self._beds.make_room(len(np.unique(self._beds.ground.cell(poses.x, poses.y), axis=0)))

    def map(self, trace: Callable[..., Any], arrays: SceneArrays, poses: Poses, *others: Integers) -> Any:
        """Trace pings, with other arrays of theirs, tile by tile: an array of the pings, or a tuple of such arrays."""
        parts = [
            (some, trace(tile, take_poses(poses, some), *(each[some] for each in others)))
            for some, tile in self.split(arrays, poses)
        ]
        if len(parts) == 1:
            return parts[0][1]
        places = np.concatenate([np.asarray(some) for some, _ in parts])
        found = [columns for _, columns in parts]
        if not isinstance(found[0], tuple):
            return _join(places, found)
        return tuple(_join(places, columns) for columns in zip(*found))

    def split(self, arrays: SceneArrays, poses: Poses) -> Iterator[tuple[Integers | slice, SceneArrays]]:
        """Sort poses by the tiles beneath them."""
        if self._beds is None or poses.x.size == 0:
            yield slice(None), arrays
            return
        cells, which = np.unique(self._beds.ground.cell(poses.x, poses.y), axis=0, return_inverse=True)
        self._beds.make_room(len(cells))
        for k, (row, column) in enumerate(cells):
            yield np.flatnonzero(which.reshape(-1) == k), arrays._replace(bed=self._beds.bed(int(row), int(column)))


class _WindowBeds:
    """Beds of the windows of endless ground; the least recently used are dropped."""

    def __init__(self, ground: EndlessGround, reach: float) -> None:
        self.ground, self._reach = ground, reach
        self._beds: OrderedDict[tuple[int, int], Bed] = OrderedDict()
        self._room = KEPT_BEDS
        self._lock = Lock()
        self.used = 0  # turn in which a bed was last used

    def make_room(self, windows: int) -> None:
        """Keep as many beds as are needed together, within `MOST_BEDS`."""
        self._room = max(self._room, min(windows, MOST_BEDS))

    def bed(self, row: int, column: int) -> Bed:
        """Bed of one window."""
        self.used = next(_TURNS)
        with self._lock:
            if (row, column) in self._beds:
                self._beds.move_to_end((row, column))
                return self._beds[row, column]
            # The kept window that shares the most ground with this one, if there is one.
            place = min(self._beds, key=lambda place: abs(place[0] - row) + abs(place[1] - column), default=None)
            near = None
            if place is not None:
                near = StoredWindow(*place, self._beds[place].heights, self._beds[place].materials)
            while len(self._beds) >= self._room:  # before the new one takes memory
                self._beds.popitem(last=False)
        made = make_bed(self.ground.window(row, column, REACH_MARGIN * self._reach, near))
        with self._lock:
            self._beds[row, column] = made
        # Beds of the grounds that were used least recently are dropped until all together are small enough.
        with _SHARING:
            grounds = sorted(_SHARED.values(), key=lambda beds: beds.used, reverse=True)
        limit = LARGEST
        for beds in grounds:
            limit -= beds.shrink(limit, least=1 if beds is self else 0)
        return made

    def shrink(self, limit: int, least: int = 0) -> int:
        """Drop the least recently used beds above a number or a size in bytes, and return the bytes left."""
        with self._lock:
            sizes = [bed.heights.nbytes + bed.transposed.nbytes + bed.materials.nbytes for bed in self._beds.values()]
            while len(sizes) > least and (len(sizes) > self._room or sum(sizes) > limit):
                self._beds.popitem(last=False)
                del sizes[0]
            return sum(sizes)


def _beds_of(ground: EndlessGround, reach: float) -> _WindowBeds:
    """Beds of the windows of endless ground; scenes on the same ground share them while one of them lives."""
    key = ground.same_windows, reach
    with _SHARING:
        beds = _SHARED.get(key)
        if beds is None:
            beds = _SHARED[key] = _WindowBeds(ground, reach)
        return beds


def drop_windows() -> None:
    """Drop the beds of all windows; those that are still needed are made again."""
    with _SHARING:
        grounds = list(_SHARED.values())
    for beds in grounds:
        beds.shrink(0)


def _join(places: Integers, columns: Sequence[Column]) -> Column:
    """Join the columns of several tiles in the order of the pings."""
    joined = np.concatenate(columns)
    ordered = np.empty_like(joined)
    ordered[places] = joined
    return ordered
