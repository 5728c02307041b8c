"""Mosaic: the swaths of several records on one grid of the map."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Bytes, Floats, Integers, Reals, Singles
from insonify.display.picture import load_palette
from insonify.io.bathymetry import LEVELS, Grid
from insonify.io.bathymetry.rasters import read_raster
from insonify.io.file_access import FileFault, guarded
from insonify.io.geotiff import write_geotiff, write_kmz
from insonify.kernels.display.swath_cells import add_samples
from insonify.scene import SceneError
from insonify.surveys import OVERLAPS
from insonify.surveys.swath import Swath

FARTHEST_GAP = 5.0  # median distances between pings over which the swath is still filled
LARGEST_SIDE = 30_000  # cells
STRIP = 2**21  # cells whose sums are in memory at once
BY_DISTANCE = ("nearest", "no-nadir")  # rules of overlaps by ground range
NADIR_GAP = math.sqrt(1.4**2 - 1.0)  # altitudes of ground range at a slant range of 1.4 altitudes
BEHIND = 1e9  # m, farther than any ground range
FAINTEST_LEVEL = -40.0  # dB, of cells without an echo
ROUND = (1.0, 2.0, 5.0)  # leading digits of a cell's size
BAND = "echo relative to the median of the record at its range"  # name of the levels in a GeoTIFF
KMZ, GEOTIFF = ".kmz", (".tif", ".tiff")
PICTURED, PALETTE = (1.0, 99.0), "copper"  # percentiles of levels, and colours, in pictures of a mosaic
NEARER = 0.01  # share by which pings may lie nearer than a cell: positions in files are rounded


@dataclass(frozen=True, eq=False)
class Mosaic:
    """Levels on a grid of the map."""

    # (rows, columns) dB relative to the median of its record at that slant range; NaN where nothing was
    # insonified; northernmost row first.
    level: Singles
    corner: tuple[float, float]  # (float, float) easting and northing of the upper left corner, in metres
    cell: float  # side of a cell, in metres
    count: NDArray[np.uint16]  # (rows, columns) records that have a sample in the cell


class Laid(Protocol):
    """A record on the map."""

    reach: float  # greatest ground range, in metres
    altitude: Floats  # (pings,) in metres
    bin_length: float  # in metres of slant range

    @property
    def spacing(self) -> float:
        """Median distance between successive pings, in metres."""

    @property
    def corners(self) -> Floats:
        """Lower left and upper right corner of the rectangle that holds it, (2, 2)."""

    def blocks(self, low: Reals, high: Reals) -> Iterator[tuple[Swath, int]]:
        """Yield the pings that reach into a rectangle: blocks, each with the ping behind it, and the number without."""


class _Layer(NamedTuple):
    """What one record has in the cells of the part of a mosaic that it reaches."""

    part: tuple[slice, slice]  # rows and columns of the mosaic
    mean: Floats  # energy; NaN where no sample lies
    distance: Floats  # mean ground range, in metres; without cells where the rule of overlaps needs none
    gap: float  # ground range up to which the bed is seen steeply and squeezed, in metres


class _Extent(NamedTuple):
    """Rectangle of cells, in whole multiples of the cell on the map."""

    low: Integers  # (2,) column and row of the lower left cell
    high: Integers  # (2,) beyond the last column and row

    def within(self, other: "_Extent") -> "_Extent":
        """Return the part within another rectangle."""
        return _Extent(np.maximum(self.low, other.low), np.minimum(self.high, other.high))

    @property
    def holds_cells(self) -> bool:
        """Whether there is any cell in it."""
        return bool((self.high > self.low).all())


def choose_cell(finest: float) -> float:
    """Return a round cell size, 1, 2 or 5 times a power of ten, no finer than a spacing of pings or bins."""
    finest *= 1.0 + NEARER
    power = 10.0 ** math.floor(math.log10(finest))
    # Rounded down, so that a cell holds about one ping.
    return power * max(digit for digit in ROUND if digit * power <= finest)


def make_mosaic(swaths: Sequence[Laid], cell: float | None = None, overlap: str = OVERLAPS[0]) -> Mosaic:
    """Put the swaths of records together; each is taken at least twice."""
    # Every swath is filled between successive pings of its record, except over gaps of more than five times their usual
    # distance, and averaged in energy within a cell. The rule of overlaps then decides between records. A large mosaic
    # is made in strips, so that the sums of few cells are in memory.
    finest, corners = zip(*((max(swath.spacing, swath.bin_length), swath.corners) for swath in swaths))
    cell = choose_cell(max(finest)) if cell is None else cell
    whole, own = _extent(np.concatenate(corners), cell), [_extent(each, cell) for each in corners]
    columns, rows = (int(size) for size in whole.high - whole.low)
    if max(rows, columns) > LARGEST_SIDE:
        raise SceneError(
            f"--cell {cell:g}: the mosaic would be {columns} by {rows} cells; widen the cell to "
            f"{cell * max(rows, columns) / LARGEST_SIDE:.2g} m or make mosaics of fewer records"
        )
    level, count = np.empty((rows, columns), np.float32), np.zeros((rows, columns), np.uint16)
    height = max(STRIP // columns, 1)
    for first in range(0, rows, height):
        last = min(first + height, rows)
        strip = _Extent(whole.low + np.array([0, first]), whole.low + np.array([columns, last]))
        parts = ((number, each.within(strip)) for number, each in enumerate(own))
        layers = (_lay(swaths[number], part, strip, cell, overlap) for number, part in parts if part.holds_cells)
        energy = _combine(layers, overlap, count[first:last])
        with np.errstate(divide="ignore"):
            level[first:last] = np.maximum(10.0 * np.log10(energy), FAINTEST_LEVEL)  # NaN stays NaN
    corner = float(whole.low[0]) * cell, float(whole.high[1]) * cell
    return Mosaic(level[::-1], corner, cell, count[::-1])


def write_mosaic(path: Path, mosaic: Mosaic, crs: str) -> None:
    """Write a mosaic as GeoTIFF, or as a picture in KMZ, which needs a map."""
    place = (mosaic.corner, mosaic.cell, crs)
    if path.suffix.lower() != KMZ:
        write_geotiff(path, mosaic.level, *place, band=BAND, unit=LEVELS)
        return
    if not crs:
        raise SceneError(f"{path.name}: the records have no place on Earth, which {KMZ} needs; write a .tif")
    write_kmz(path, colour_levels(mosaic.level), *place)


def read_levels(path: Path) -> Grid:
    """Read a mosaic, or other levels on a map, from a GeoTIFF."""
    with guarded(lambda fault, remedy: SceneError(f"{path.name}: {fault}; {remedy}"), "give a GeoTIFF"):
        if path.suffix.lower() not in GEOTIFF:
            raise FileFault("is no GeoTIFF", f"give a file that ends in {' or '.join(GEOTIFF)}")
        grid = read_raster(str(path))
        if not np.isfinite(grid.heights).any():
            raise FileFault("holds no level", "make the mosaic again")
        if grid.corner is None:
            raise FileFault("names no place of its corner", "georeference it")
    return grid


def colour_levels(level: Reals) -> Bytes:
    """Colour levels: (rows, columns, 4) red, green, blue and opacity, which is 0 where there is none."""
    low, high = np.nanpercentile(level, PICTURED)
    tone = np.nan_to_num(np.clip((level - low) / max(high - low, 1e-9), 0.0, 1.0))
    colours = load_palette(PALETTE)[(255.0 * tone).astype(np.uint8)]
    return np.dstack([colours, np.where(np.isnan(level), 0, 255)]).astype(np.uint8)


def _extent(points: Floats, cell: float) -> _Extent:
    """Cells that hold points of the map, (n, 2)."""
    low, high = np.floor(points.min(axis=0) / cell), np.floor(points.max(axis=0) / cell) + 1.0
    return _Extent(low.astype(np.int64), high.astype(np.int64))


def _lay(swath: Laid, own: _Extent, strip: _Extent, cell: float, overlap: str) -> _Layer:
    """Average the samples of one record in the cells of a strip that it reaches."""
    columns, rows = own.high - own.low
    shape = rows, columns
    energy, count = np.zeros(shape), np.zeros(shape, dtype=np.int32)
    ground_range = np.zeros(shape if overlap in BY_DISTANCE else (0, 0))
    longest = max(FARTHEST_GAP * swath.spacing, 2.0 * cell)
    for block, pings in swath.blocks(own.low * cell, own.high * cell):
        add_samples(block, pings, own.low * cell, cell, longest, energy, ground_range, count)
    left, bottom = own.low - strip.low
    with np.errstate(invalid="ignore"):
        energy /= count
        ground_range /= count if ground_range.size else 1.0
    gap = NADIR_GAP * float(np.nanmedian(swath.altitude))
    return _Layer((slice(bottom, bottom + rows), slice(left, left + columns)), energy, ground_range, gap)


def _combine(layers: Iterable[_Layer], overlap: str, counts: NDArray[np.uint16]) -> Floats:
    """Energy of every cell by the rule of overlaps, NaN where no record has a sample; counts records that have."""
    whole = np.full(counts.shape, np.nan)
    nearest = np.full(counts.shape if overlap in BY_DISTANCE else (0, 0), np.inf)
    for part, mean, distance, gap in layers:
        energy, count, filled = whole[part], counts[part], np.isfinite(mean)
        if overlap == "mean":
            total = np.where(count > 0, energy, 0.0) * count + mean
            count += filled
            energy[filled] = (total / np.maximum(count, 1))[filled]
            continue
        count += filled
        if overlap == "no-nadir":  # what lies within the gap of one record counts only where no other reaches
            distance = np.where(distance < gap, BEHIND - distance, distance)
        if overlap in BY_DISTANCE:
            better = filled & (distance < nearest[part])
            nearest[part][better] = distance[better]
        else:
            better = filled if overlap == "last" else filled & ~(mean <= energy)
        energy[better] = mean[better]
    return whole
