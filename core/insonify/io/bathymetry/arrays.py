"""Grids of heights in files of NumPy, and the samples that come with matplotlib."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.io.bathymetry.grid import BATHYMETRY, HEIGHT, Grid, check_size, check_type
from insonify.io.file_access import FileFault, check_expansion
from insonify.io.formats import FileFormat
from insonify.io.numpy_files import Archive, read_npy

NAMES = ("elevation", "z")
SAMPLE = "sample:"
# File, array, and whether its first row is the northernmost.
SAMPLES = {
    "jacksboro": ("jacksboro_fault_dem.npz", "elevation", True),
    "topobathy": ("topobathy.npz", "topo", False),
}


def read_array(path: str) -> Grid:
    """Read ``.npy``, or ``.npz``: its ``elevation`` or ``z``, else its first 2-D array; rows run towards +y."""
    if path.lower().endswith(".npy"):
        array = read_npy(path)
    else:
        with Archive(path) as stored:
            array = _pick(stored)
    check_expansion(path, array.size * HEIGHT)
    return Grid(_heights(array))


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
        heights = _heights(stored[key])
    return Grid(np.ascontiguousarray(heights[::-1]) if northern_first else heights)


def _pick(stored: Archive) -> NDArray[Any]:
    """Return the array that holds the heights: elevation or z, else the first 2-D array."""
    arrays = map(stored.__getitem__, [*(name for name in NAMES if name in stored.names), *stored.names])
    found = next((array for array in arrays if array.ndim == 2), None)
    if found is None:
        raise FileFault("holds no 2-D array", "save the heights as a 2-D array named elevation")
    return found


def _heights(array: NDArray[Any]) -> NDArray[np.float64]:
    """Check an array of heights and replace infinite values by NaN."""
    if array.ndim != 2:
        raise FileFault(f"has {array.ndim} dimensions", "save the heights as a 2-D array")
    check_type(array.dtype)
    check_size(array.shape)
    heights = array.astype(np.float64)
    heights[~np.isfinite(heights)] = np.nan
    return heights


ARRAYS = FileFormat("NumPy array", (".npy", ".npz"), read_array, remedy="save it with numpy.save or numpy.savez")
