"""Measured bathymetry: grids of heights in files, and the checks that every format shares.

A format is one module here that holds a `FileFormat`.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Floats
from insonify.errors import FileWarning, warn_caller
from insonify.io.file_access import FileFault
from insonify.io.formats import FormatRegistry

__all__ = ["BATHYMETRY", "Grid", "read_grid"]

# A bed of 16384² float32 nodes takes 1 GB.
LARGEST_SIDE = 16384
HEIGHT = 8  # bytes of a height
# Values that programs write where there is no height.
NODATA = frozenset(
    sign * value
    for value in (9999.0, 99999.0, 999999.0, 32767.0, 32768.0, 65535.0, 2.0**31 - 1.0, 2.0**31, 1e6, 1e20)
    for sign in (-1.0, 1.0)
)
APART_FROM_HEIGHTS = 1000.0  # a customary value closer than that to another number of the file may be a height
FINE = 0.02  # a cell in degrees, 2 km, and finer than one of bathymetry in metres
LEVELS = "dB"  # unit of a mosaic
SAMPLE = "sample:"
# File, array, and whether its first row is the northernmost.
SAMPLE_FILES = {
    "jacksboro": ("jacksboro_fault_dem.npz", "elevation", True),
    "topobathy": ("topobathy.npz", "topo", False),
}


@dataclass(frozen=True, eq=False)
class Grid:
    """Heights on a grid."""

    # (ny, nx) metres, positive up unless they are depths, NaN where there are none; axis 0 is y, axis 1 is x,
    # both increasing.
    heights: Floats
    # (float, float) metres between nodes along x and y; None if the file has none.
    spacing: tuple[float, float] | None = None
    # (float, float) map coordinates of node (0, 0); None if the file has none.
    corner: tuple[float, float] | None = None
    crs: str = ""  # coordinate reference system of the map, as PROJ takes it; empty if the file names none
    # Whether ``heights`` are depths, positive down, as the file declares.
    depths: bool = False
    unit: str = ""  # as the file names it; heights and depths are in metres whatever it was


BATHYMETRY: FormatRegistry[Grid] = FormatRegistry(
    "a grid of heights",
    "insonify.io.bathymetry",
    "insonify.bathymetry_formats",
    "seabed.relief.path: {path!r} {fault}; {remedy}",
)


def read_grid(path: str) -> Grid:
    """Read a grid of heights."""
    with BATHYMETRY.guarded(path):
        grid = _read_sample(path) if path.startswith(SAMPLE) else BATHYMETRY.read(path)
        if not np.isfinite(grid.heights).any():
            raise FileFault("holds no valid height", "check its nodata value")
        if not grid.crs and grid.spacing and grid.corner and _looks_like_degrees(grid.spacing, grid.corner):
            advice = (
                "if they are degrees, name its reference system, for example in a .prj file or with rio edit-info --crs"
            )
            text = f"{path}: has no reference system, and its cells of {grid.spacing[0]:g} count as metres; {advice}"
            warn_caller(FileWarning(text))
    return grid


def _looks_like_degrees(spacing: tuple[float, float], corner: tuple[float, float]) -> bool:
    """Whether cells are fine for metres and lie away from the origin, at a possible longitude and latitude."""
    east, north = map(abs, corner)
    return spacing[0] < FINE < 0.01 * max(east, north) and east <= 360.0 and north <= 90.0


def _read_sample(path: str) -> Grid:
    """Read a digital elevation model that comes with matplotlib: ``sample:jacksboro`` or ``sample:topobathy``."""
    from matplotlib import cbook

    name = path.removeprefix(SAMPLE)
    if name not in SAMPLE_FILES:
        raise FileFault("is not a sample known here", f"choose {' or '.join(SAMPLE + name for name in SAMPLE_FILES)}")
    file, key, northern_first = SAMPLE_FILES[name]
    with np.load(Path(str(cbook.get_sample_data(file, asfileobj=False)))) as stored:
        heights = check_heights(stored[key])
    return Grid(np.ascontiguousarray(heights[::-1]) if northern_first else heights)


def check_nodata(heights: NDArray[Any]) -> None:
    """Raise FileFault for an undeclared customary nodata value that stands alone or far from all other heights."""
    for value in {float(heights.min()), float(heights.max())} & NODATA if heights.size else ():
        others = heights[heights != value]
        if np.abs(others - value).min(initial=np.inf) > APART_FROM_HEIGHTS:
            raise FileFault(
                f"has {heights.size - others.size} cells of {value:.15g}, which it does not declare as nodata",
                f"declare it, for example with gdal_edit.py -a_nodata {value:.15g}, or set those cells to NaN",
            )


def check_heights(array: NDArray[Any]) -> Floats:
    """Check an array of heights and replace infinite values by NaN."""
    if array.ndim != 2:
        raise FileFault(f"has {array.ndim} dimensions", "save the heights as a 2-D array")
    check_type(array.dtype)
    check_size(array.shape)
    heights = array.astype(np.float64)
    heights[~np.isfinite(heights)] = np.nan
    check_nodata(heights[np.isfinite(heights)])
    return heights


def check_size(shape: tuple[int, ...]) -> None:
    """Raise FileFault for a grid too small to span a cell or too large to hold."""
    if min(shape) < 2:
        raise FileFault(f"is only {shape[1]} by {shape[0]} heights", "give at least 2 by 2")
    if max(shape) > LARGEST_SIDE:
        raise FileFault(f"is {shape[1]} by {shape[0]} heights", f"crop or thin it to {LARGEST_SIDE} a side")


def check_type(stored: np.dtype[Any]) -> None:
    """Raise FileFault for values that are not real numbers: complex numbers, booleans, text."""
    if stored.kind not in "fiu":
        raise FileFault(f"holds {stored} values", "save the heights as real numbers")
