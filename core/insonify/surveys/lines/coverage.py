"""Mosaic of a survey from the records on disk, one at a time, and how much of the area they cover."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.io.georeference import find_georeference
from insonify.io.records import read_record
from insonify.surveys.mosaic import Mosaic
from insonify.surveys.swath import Swath, choose_map, lay_swath, put_on_map


class Coverage(NamedTuple):
    """Area that a survey covers."""

    area: float  # that is asked for, or without one that is covered, in m²
    once: float  # shares of it that at least one line, and at least two lines, show
    twice: float


class StoredSwaths(Collection[Swath]):
    """Swaths of records, read anew whenever they are passed through, so that one is held at a time."""

    def __init__(self, folder: Path, files: Sequence[str]) -> None:
        self._paths = [str(folder / file) for file in files]
        first = read_record(self._paths[0])
        self.place = find_georeference(first.attrs)
        self.crs = choose_map(self._paths[0], first, None)

    def __len__(self) -> int:
        return len(self._paths)

    def __contains__(self, item: object) -> bool:
        return False

    def __iter__(self) -> Iterator[Swath]:
        return (lay_swath(os.path.basename(path), read_record(path), self.crs) for path in self._paths)

    def on_map(self, points: Sequence[tuple[float, float]]) -> NDArray[np.float64]:
        """Map points of the scene to the map of the swaths, (n, 2)."""
        x, y = np.array(points, dtype=np.float64).T
        return put_on_map(self._paths[0], self.place, self.crs, x, y)


def measure_coverage(mosaic: Mosaic, corners: NDArray[np.float64] | None) -> Coverage:
    """Measure how much of an area the lines of a survey show."""
    square = mosaic.cell**2
    if corners is None:
        area = float((mosaic.count > 0).sum()) * square
        count = mosaic.count
    else:
        x, y = corners.T
        area = 0.5 * abs(float(x @ np.roll(y, 1) - y @ np.roll(x, 1)))
        count = mosaic.count[within(mosaic, corners)]
    shares = [min(float((count >= lines).sum()) * square / area, 1.0) for lines in (1, 2)]
    return Coverage(area, *shares)


def within(mosaic: Mosaic, corners: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which cells of a mosaic have their centres within an area, (rows, columns)."""
    # lazy: slow to import
    from skimage.draw import polygon2mask

    left, top = mosaic.corner
    rows = (top - corners[:, 1]) / mosaic.cell - 0.5
    columns = (corners[:, 0] - left) / mosaic.cell - 0.5
    outline = np.stack([rows, columns], axis=1)
    return np.asarray(polygon2mask(mosaic.count.shape, outline))  # type: ignore[no-untyped-call]  # of scikit-image
