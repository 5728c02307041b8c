"""Records as NumPy archives, one array for each variable."""

import zipfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Dataset
from insonify.io.formats import FileFormat
from insonify.io.numpy_files import SUFFIX, Archive
from insonify.io.record_block import RecordBlock, make_record_block
from insonify.io.record_schema import ACROSS, BOX, ERRORS, TARGET_TRUTH

ALONG = "ping_time"
ALONG_RANGE = ("slant_range", "travel_time")  # coordinates
ATTRIBUTE = "attrs."  # before the names of attributes


def write_npz(path: str | Path, blocks: Iterable[RecordBlock]) -> None:
    """Write a record as one array for each variable; readable by ``numpy.load`` without pickles."""
    # An archive is written at once, so that the record must fit in memory; netCDF suits long tracks.
    parts = list(blocks)
    with zipfile.ZipFile(path, "w") as archive:
        for name, variable in parts[0].variables.items():
            along = ALONG in variable.dims
            used = parts if along else parts[-1:] if name in TARGET_TRUTH else parts[:1]
            axis = variable.dims.index(ALONG) if along else 0
            _write_joined(archive, name, [_stored(part.variables[name].values) for part in used], axis)
        for key, value in parts[-1].attributes.items():
            _write_joined(archive, f"{ATTRIBUTE}{key}", [_stored(np.array(value))], 0)


def _stored(values: NDArray[Any]) -> NDArray[Any]:
    """Return an array that needs no pickle."""
    return values.astype(object).astype(str) if values.dtype.kind in "OT" else values


def _write_joined(archive: zipfile.ZipFile, name: str, parts: list[NDArray[Any]], axis: int) -> None:
    """Write arrays one behind the other along an axis, without joining them in memory, which would double the time."""
    dtype = np.result_type(*parts)
    shape = [*parts[0].shape]
    if shape:
        shape[axis] = sum(part.shape[axis] for part in parts)
    header = {"descr": np.lib.format.dtype_to_descr(dtype), "fortran_order": False, "shape": tuple(shape)}
    with archive.open(f"{name}{SUFFIX}", "w", force_zip64=True) as file:
        np.lib.format.write_array_header_2_0(file, header)
        for index in np.ndindex(*shape[:axis]):
            for part in parts:
                # Times have no buffer, bytes have.
                file.write(np.ascontiguousarray(part[index], dtype).reshape(-1).view(np.uint8).data)


def read_npz(path: str | Path) -> Dataset:
    """Read a record written by `write_npz`."""
    with Archive(str(path)) as stored:
        arrays = {name: stored[name] for name in stored.names}
    names = [name for name in arrays if name.startswith(ATTRIBUTE)]
    attributes = {name.removeprefix(ATTRIBUTE): arrays.pop(name).item() for name in names}
    sizes = dict(zip(ACROSS, arrays["intensity"].shape))
    named: dict[str, Any] = {
        name: (_dimensions(name, values.shape, sizes), values, {}) for name, values in arrays.items()
    }
    coordinates = {name: named.pop(name) for name in ALONG_RANGE if name in named}
    return make_record_block(named, coordinates, attributes).to_dataset()


def _dimensions(name: str, shape: tuple[int, ...], sizes: dict[str, int]) -> tuple[str, ...]:
    """Name the dimensions of an array, which an archive does not keep, by its name or by its number of dimensions."""
    described: dict[str, Any] = TARGET_TRUTH | ERRORS
    if name in described:
        return tuple(described[name][0])
    if name in (*sizes, *BOX):
        return (name,)
    if len(shape) == len(ACROSS):
        return ACROSS
    across = ("range_sample",) if name in ALONG_RANGE else ("ping_time",)
    return across[: len(shape)]


NPZ = FileFormat(
    "NumPy arrays",
    (".npz",),
    read_npz,
    write_npz,
    remedy="give a record written by insonify",
    labelled=True,
    of_blocks=True,
)
