"""Measured bathymetry: a format is one module here that holds a `FileFormat`."""

from __future__ import annotations

import numpy as np

from insonify.io.bathymetry.arrays import SAMPLE, read_sample
from insonify.io.bathymetry.grid import BATHYMETRY, Grid

__all__ = ["BATHYMETRY", "Grid", "read_grid"]


def read_grid(path: str) -> Grid:
    """Read a grid of heights.

    Parameters
    ----------
    path : str
        A file of one of the formats of `BATHYMETRY`, or ``sample:jacksboro`` or ``sample:topobathy``.

    Returns
    -------
    Grid
        Heights positive up, at least one of them finite.

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    grid = read_sample(path) if path.startswith(SAMPLE) else BATHYMETRY.read(path)
    if not np.isfinite(grid.heights).any():
        raise BATHYMETRY.refusal(path, "holds no valid height", "check its nodata value")
    return grid
