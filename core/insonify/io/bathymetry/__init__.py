"""Measured bathymetry: a format is one module here that holds a `FileFormat`."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from insonify.io.bathymetry.arrays import SAMPLE, read_sample
from insonify.io.bathymetry.grid import BATHYMETRY, Grid

__all__ = ["BATHYMETRY", "Grid", "read_grid"]

# Values that programs write where there is no height.
NODATA = frozenset(
    sign * value for value in (9999.0, 99999.0, 999999.0, 32767.0, 32768.0, 1e6, 1e20) for sign in (-1.0, 1.0)
)
FAR = 1000.0  # m: a customary value closer than that to another height may be a height


def read_grid(path: str) -> Grid:
    """Read a grid of heights."""
    grid = read_sample(path) if path.startswith(SAMPLE) else BATHYMETRY.read(path)
    if not np.isfinite(grid.heights).any():
        raise BATHYMETRY.refusal(path, "holds no valid height", "check its nodata value")
    _refuse_nodata(path, grid.heights[np.isfinite(grid.heights)])
    return grid


def _refuse_nodata(path: str, heights: NDArray[np.float64]) -> None:
    """Refuse a customary nodata value, alone or far from all other heights, that the file does not declare."""
    for value in (heights.min(), heights.max()):
        others = heights[heights != value]
        if value in NODATA and np.abs(others - value).min(initial=np.inf) > FAR:
            raise BATHYMETRY.refusal(
                path,
                f"has {heights.size - others.size} cells of {value:g}, which it does not declare as nodata",
                f"declare it, for example with gdal_edit.py -a_nodata {value:g}, or set those cells to NaN",
            )
