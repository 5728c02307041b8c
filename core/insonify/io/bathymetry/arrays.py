"""Grids of heights in files of NumPy."""

from typing import Any

from numpy.typing import NDArray

from insonify.io.bathymetry import HEIGHT, Grid, check_heights
from insonify.io.file_access import FileFault, check_expansion
from insonify.io.formats import FileFormat
from insonify.io.numpy_files import Archive, read_npy

NAMES = ("elevation", "z")


def read_array(path: str) -> Grid:
    """Read ``.npy``, or ``.npz``: its ``elevation`` or ``z``, else its first 2-D array; rows run towards +y."""
    if path.lower().endswith(".npy"):
        array = read_npy(path)
    else:
        with Archive(path) as stored:
            array = _pick(stored)
    check_expansion(path, array.size * HEIGHT)
    return Grid(check_heights(array))


def _pick(stored: Archive) -> NDArray[Any]:
    """Return the array that holds the heights: elevation or z, else the first 2-D array."""
    arrays = map(stored.__getitem__, [*(name for name in NAMES if name in stored.names), *stored.names])
    found = next((array for array in arrays if array.ndim == 2), None)
    if found is None:
        raise FileFault("holds no 2-D array", "save the heights as a 2-D array named elevation")
    return found


ARRAYS = FileFormat("NumPy array", (".npy", ".npz"), read_array, remedy="save it with numpy.save or numpy.savez")
