"""Grids of heights in files of NumPy, and the samples that come with matplotlib."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.io.bathymetry.grid import BATHYMETRY, Grid, check_size, check_type
from insonify.io.formats import FileFormat

NAMES = ("elevation", "z")
SAMPLE = "sample:"
# File, array, and whether its first row is the northernmost.
SAMPLES = {
    "jacksboro": ("jacksboro_fault_dem.npz", "elevation", True),
    "topobathy": ("topobathy.npz", "topo", False),
}


def read_array(path: str) -> Grid:
    """Read ``.npy``, or ``.npz``: its ``elevation`` or ``z``, else its first 2-D array; rows run towards +y."""
    try:
        stored = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise BATHYMETRY.unreadable(path, error, "save it with numpy.save or numpy.savez") from None
    if isinstance(stored, np.ndarray):
        return Grid(_heights(path, stored))
    with stored:
        return Grid(_heights(path, _pick(path, stored)))


def read_sample(path: str) -> Grid:
    """Read a digital elevation model that comes with matplotlib: ``sample:jacksboro`` or ``sample:topobathy``."""
    from matplotlib import cbook

    name = path.removeprefix(SAMPLE)
    if name not in SAMPLES:
        raise BATHYMETRY.refusal(
            path, "is not a sample known here", f"choose {' or '.join(SAMPLE + name for name in SAMPLES)}"
        )
    file, key, northern_first = SAMPLES[name]
    with np.load(Path(str(cbook.get_sample_data(file, asfileobj=False)))) as stored:
        heights = _heights(path, stored[key])
    return Grid(np.ascontiguousarray(heights[::-1]) if northern_first else heights)


def _pick(path: str, stored: Mapping[str, Any]) -> NDArray[Any]:
    """Return the array that holds the heights: elevation or z, else the first 2-D array."""
    arrays = map(partial(_get, path, stored), [*(name for name in NAMES if name in stored), *stored])
    found = next((array for array in arrays if array.ndim == 2), None)
    if found is None:
        raise BATHYMETRY.refusal(path, "holds no 2-D array", "save the heights as a 2-D array named elevation")
    return found


def _get(path: str, stored: Mapping[str, Any], name: str) -> NDArray[Any]:
    try:
        return np.asarray(stored[name])
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        raise BATHYMETRY.unreadable(path, error, "save it with numpy.savez as plain numbers") from None


def _heights(path: str, array: NDArray[Any]) -> NDArray[np.float64]:
    """Check an array of heights and replace infinite values by NaN."""
    if array.ndim != 2:
        raise BATHYMETRY.refusal(path, f"has {array.ndim} dimensions", "save the heights as a 2-D array")
    check_type(path, array.dtype)
    check_size(path, array.shape)
    heights = array.astype(np.float64)
    heights[~np.isfinite(heights)] = np.nan
    return heights


ARRAYS = FileFormat("NumPy array", (".npy", ".npz"), read_array)
