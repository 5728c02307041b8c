"""Records as NumPy archives, one array for each variable."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from insonify.io.formats import FileFormat
from insonify.io.numpy_files import Archive
from insonify.io.record_schema import ACROSS, dimensions_of, join_blocks

if TYPE_CHECKING:
    import xarray as xr

ALONG_RANGE = ("slant_range", "travel_time")  # coordinates
ATTRIBUTE = "attrs."  # before the names of attributes


def write_npz(path: str | Path, blocks: Iterable[xr.Dataset]) -> None:
    """Write a record as one array for each variable; readable by ``numpy.load`` without pickles.

    An archive is written at once, so that the record must fit in memory; netCDF suits long tracks.

    Parameters
    ----------
    path : str or Path
        File to write.
    blocks : iterable of Dataset
        Successive pings. Variables and coordinates keep their names and shapes; attributes become ``attrs.<name>``.
    """
    record = join_blocks(list(blocks))
    arrays = {str(name): variable.values for name, variable in record.variables.items()}
    arrays |= {f"{ATTRIBUTE}{key}": np.array(value) for key, value in record.attrs.items()}
    arrays = {
        name: values.astype(object).astype(str) if values.dtype.kind in "OT" else values
        for name, values in arrays.items()
    }
    with Path(path).open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]


def read_npz(path: str | Path) -> xr.Dataset:
    """Read a record written by `write_npz`."""
    import xarray as xr  # slow to import, and no other command needs it at its start

    with Archive(str(path)) as stored:
        arrays = {name: stored[name] for name in stored.names}
    told = [name for name in arrays if name.startswith(ATTRIBUTE)]
    attributes = {name.removeprefix(ATTRIBUTE): arrays.pop(name).item() for name in told}
    sizes = dict(zip(ACROSS, arrays["intensity"].shape))
    named = {name: (_dimensions(name, values.shape, sizes), values) for name, values in arrays.items()}
    return xr.Dataset(named, attrs=attributes).set_coords([name for name in ALONG_RANGE if name in named])


def _dimensions(name: str, shape: tuple[int, ...], sizes: dict[str, int]) -> tuple[str, ...]:
    """Name the dimensions of an array, which an archive does not keep, by its name or by its number of dimensions."""
    told = (name,) if name in sizes else dimensions_of(name)
    if told is not None:
        return told
    if len(shape) == len(ACROSS):
        return ACROSS
    across = ("range_sample",) if name in ALONG_RANGE else ("ping_time",)
    return across[: len(shape)]


NPZ = FileFormat(
    "NumPy arrays", (".npz",), read_npz, write_npz, remedy="give a record written by insonify", labelled=True
)
