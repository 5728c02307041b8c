"""Mosaic: the swaths of several records on one grid of the map."""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Bytes, Floats, Integers, Reals, Singles
from insonify.display.picture import load_palette
from insonify.io.bathymetry import LEVELS, Grid
from insonify.io.bathymetry.rasters import read_raster
from insonify.io.file_access import FileFault, guarded
from insonify.io.geotiff import write_geotiff, write_kmz
from insonify.scene import SceneError
from insonify.surveys import OVERLAPS
from insonify.surveys.swath import Swath

FARTHEST_GAP = 5.0  # median distances between pings over which the swath is still filled
LARGEST_SIDE = 30_000  # cells
NADIR_GAP = math.sqrt(1.4**2 - 1.0)  # altitudes of ground range at a slant range of 1.4 altitudes
BEHIND = 1e9  # m, farther than any ground range
FAINTEST = -40.0  # dB, of cells without an echo
ROUND = (1.0, 2.0, 5.0)  # leading digits of a cell's size
BAND = "echo relative to the median of the record at its range"  # name of the levels in a GeoTIFF
KMZ, GEOTIFF = ".kmz", (".tif", ".tiff")
PICTURED, PALETTE = (1.0, 99.0), "copper"  # percentiles of levels, and colours, in pictures of a mosaic
ALIKE = 0.01  # share by which pings may lie nearer than a cell: positions in files are rounded


@dataclass(frozen=True, eq=False)
class Mosaic:
    """Levels on a grid of the map."""

    # (rows, columns) dB relative to the median of its record at that slant range; NaN where nothing was
    # insonified; northernmost row first.
    level: Singles
    corner: tuple[float, float]  # (float, float) easting and northing of the upper left corner, in metres
    cell: float  # side of a cell, in metres
    count: NDArray[np.uint16]  # (rows, columns) records that have a sample in the cell


@dataclass(eq=False)
class _Layer:
    """Sums over the samples of one record in every cell."""

    energy: Floats
    ground_range: Floats
    count: Integers
    gap: float  # ground range up to which the bed is seen steeply and squeezed, in metres


def choose_cell(swaths: Collection[Swath]) -> float:
    """Return a round cell size, 1, 2 or 5 times a power of ten, no finer than the pings and the bins of the records."""
    finest = max(max(swath.spacing, swath.bin_length) for swath in swaths) * (1.0 + ALIKE)
    power = 10.0 ** math.floor(math.log10(finest))
    # Rounded down, so that a cell holds about one ping.
    return power * max(digit for digit in ROUND if digit * power <= finest)


def make_mosaic(swaths: Collection[Swath], cell: float | None = None, overlap: str = OVERLAPS[0]) -> Mosaic:
    """Put the swaths of records together."""
    # Every swath is filled between successive pings of its record, except over gaps of more than five times their usual
    # distance, and averaged in energy within a cell. The rule of overlaps then decides between records.
    cell = choose_cell(swaths) if cell is None else cell
    low, shape = _extent(swaths, cell)
    layers = (_lay(swath, low, shape, cell) for swath in swaths)
    energy, count = _combine(layers, overlap, shape)
    with np.errstate(divide="ignore"):
        level = np.maximum(10.0 * np.log10(energy), FAINTEST)  # NaN stays NaN
    return Mosaic(level.astype(np.float32)[::-1], (low[0], low[1] + shape[0] * cell), cell, count[::-1])


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


def _extent(swaths: Collection[Swath], cell: float) -> tuple[tuple[float, float], tuple[int, int]]:
    """Lower left corner and shape of the grid that holds all swaths, on whole multiples of the cell."""
    points = np.concatenate([np.concatenate([swath.nadir, swath.ends.reshape(-1, 2)]) for swath in swaths])
    low, high = np.floor(points.min(axis=0) / cell), np.floor(points.max(axis=0) / cell) + 1.0
    columns, rows = (int(size) for size in high - low)
    if max(rows, columns) > LARGEST_SIDE:
        raise SceneError(
            f"--cell {cell:g}: the mosaic would be {columns} by {rows} cells; widen the cell to "
            f"{cell * max(rows, columns) / LARGEST_SIDE:.2g} m or make mosaics of fewer records"
        )
    return (float(low[0] * cell), float(low[1] * cell)), (rows, columns)


def _lay(swath: Swath, low: tuple[float, float], shape: tuple[int, int], cell: float) -> _Layer:
    """Add up the samples of one record in every cell."""
    # Samples are dense enough, half a cell apart at most, that each cell within the swath holds one.
    gap = NADIR_GAP * float(np.nanmedian(swath.altitude))
    layer = _Layer(np.zeros(shape), np.zeros(shape), np.zeros(shape, dtype=np.int64), gap)
    step = min(0.5 * cell, swath.bin_length)
    ground_range = np.arange(0.5 * step, swath.reach, step, dtype=np.float64)
    longest = max(FARTHEST_GAP * swath.spacing, 2.0 * cell)
    last = len(swath.nadir) - 1
    heard = swath.energy(0, ground_range)
    for ping in range(max(last, 1)):
        following = min(ping + 1, last)
        next_heard = swath.energy(following, ground_range)
        moved = float(np.hypot(*(swath.nadir[following] - swath.nadir[ping])))
        turned = float(np.hypot(*(swath.ends[following] - swath.ends[ping]).T).max())
        parts = math.ceil(max(moved, turned) / (0.5 * cell)) if moved <= longest else 1
        for part in range(max(parts, 1)):
            share = part / parts if parts > 1 else 0.0
            between = (1.0 - share) * heard + share * next_heard if share else heard
            _add(layer, _places(swath, ping, following, share, ground_range), ground_range, between, low, cell)
        heard = next_heard
    if last > 0:
        _add(layer, _places(swath, last, last, 0.0, ground_range), ground_range, heard, low, cell)
    return layer


def _places(swath: Swath, ping: int, following: int, share: float, ground_range: Floats) -> Floats:
    """Positions of samples on both sides between two pings, (2, n, 2)."""
    nadir = (1.0 - share) * swath.nadir[ping] + share * swath.nadir[following]
    ends = (1.0 - share) * swath.ends[ping] + share * swath.ends[following]
    along = (ground_range / swath.reach)[None, :, None]
    return nadir + along * (ends - nadir)[:, None, :]


def _add(
    layer: _Layer, places: Floats, ground_range: Floats, energy: Floats, low: tuple[float, float], cell: float
) -> None:
    """Add samples to the cells that hold them."""
    heard = np.isfinite(energy)
    column, row = np.floor((places[heard] - low) / cell).astype(np.int64).T
    at = row * layer.count.shape[1] + column
    np.add.at(layer.energy.reshape(-1), at, energy[heard])
    np.add.at(layer.ground_range.reshape(-1), at, np.broadcast_to(ground_range, heard.shape)[heard])
    np.add.at(layer.count.reshape(-1), at, 1)


def _combine(layers: Iterable[_Layer], overlap: str, shape: tuple[int, int]) -> tuple[Floats, NDArray[np.uint16]]:
    """Energy of every cell by the rule of overlaps, NaN where no record has a sample; number of records that have."""
    energy, count, nearest = np.full(shape, np.nan), np.zeros(shape, np.uint16), np.full(shape, np.inf)
    for layer in layers:
        filled = layer.count > 0
        counts = np.maximum(layer.count, 1)
        mean, distance = layer.energy / counts, layer.ground_range / counts
        if overlap == "no-nadir":  # what lies within the gap of one record counts only where no other reaches
            distance = np.where(distance < layer.gap, BEHIND - distance, distance)
        if overlap == "mean":
            total = np.where(count > 0, energy, 0.0) * count + mean
            count += filled
            energy = np.where(filled, total / np.maximum(count, 1), energy)
            continue
        count += filled
        better = {
            "last": filled,
            "strongest": filled & ~(mean <= energy),
        }.get(overlap, filled & (distance < nearest))
        energy, nearest = np.where(better, mean, energy), np.where(better, distance, nearest)
    return energy, count
