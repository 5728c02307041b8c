"""Readers of measured beds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from insonify.io.bathymetry.arrays import SAMPLE, read_array, read_sample
from insonify.io.bathymetry.grid import Grid, refusal

__all__ = ["Grid", "read_grid", "refusal"]

ARRAYS = (".npy", ".npz")
RASTERS = (".tif", ".tiff", ".bag", ".asc")


def read_grid(path: str) -> Grid:
    """Read a grid of heights.

    Parameters
    ----------
    path : str
        GeoTIFF, BAG, ESRI ASCII grid (``.asc``), ``.npy`` or ``.npz``, or ``sample:jacksboro`` or ``sample:topobathy``.

    Returns
    -------
    Grid
        Heights positive up, at least one of them finite.

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    grid = _read(path)
    if not np.isfinite(grid.heights).any():
        raise refusal(path, "holds no valid height", "check its nodata value")
    return grid


def _read(path: str) -> Grid:
    if path.startswith(SAMPLE):
        return read_sample(path)
    suffix = Path(path).suffix.lower()
    if suffix not in ARRAYS + RASTERS:
        known = ", ".join(ARRAYS + RASTERS)
        raise refusal(path, "is not a format known here", f"give a file that ends in one of {known}")
    if not Path(path).is_file():
        raise refusal(path, "does not exist", "give the path of a grid of heights")
    if suffix in ARRAYS:
        return read_array(path)
    # GDAL takes a fifth of a second to load; only rasters need it.
    from insonify.io.bathymetry.rasters import read_raster

    return read_raster(path)
