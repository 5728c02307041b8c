"""Records as netCDF, written block by block, so that memory does not grow with the number of pings."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Dataset
from insonify.io.file_access import FileFault, check_expansion, disk_errors, one_at_a_time
from insonify.io.formats import FileFormat, WriteOption
from insonify.io.isolation import run_isolated
from insonify.io.record_block import RecordBlock, RecordVariable, make_record_block
from insonify.io.record_schema import CONVENTIONS, TARGET_TRUTH
from insonify.io.records.sonar_netcdf import write_sonar_netcdf

ALONG = "ping_time"
CHUNK_BYTES = 1e6
EPOCH = "nanoseconds since 1970-01-01"
TEXT = 64  # bytes taken for a text of unknown length
NUMBER = 8  # bytes that a number may take after it is decoded


def write_netcdf(
    path: str | Path, blocks: Iterable[RecordBlock], *, compression: str = "none", convention: str = "cf"
) -> None:
    """Write a record block by block."""
    if convention != "cf":
        return write_sonar_netcdf(path, blocks)
    import netCDF4  # slow to import, and no other command needs it at its start

    with one_at_a_time():
        file = netCDF4.Dataset(path, "w", format="NETCDF4")
    try:
        for block in blocks:
            with one_at_a_time(), disk_errors():
                append_to(file, block, compression)
    finally:
        with one_at_a_time(), disk_errors():
            file.close()


def read_netcdf(path: str | Path) -> Dataset:
    """Read a record written by `write_netcdf`."""
    import xarray as xr  # slow to import too

    return xr.decode_cf(run_isolated(read_with_netcdf, str(path)).to_dataset())


def read_with_netcdf(path: str) -> RecordBlock:
    """Read the variables of the root group as they are stored, in this process, which the library may crash."""
    import netCDF4  # slow to import

    with netCDF4.Dataset(path) as file:
        if "sonar_convention_name" in file.ncattrs():
            raise FileFault("is in SONAR-netCDF4, which is only written", "give the record from which it was made")
        file.set_auto_maskandscale(False)
        check_variables(path, file.variables.values())
        variables = {
            str(name): (each.dimensions, np.asarray(each[...]), _stored_attributes(each))
            for name, each in file.variables.items()
        }
        return make_record_block(variables, {}, _stored_attributes(file))


def check_variables(path: str, variables: Iterable[Any]) -> None:
    """Raise FileFault for variables that take too much memory, or hold anything but numbers and text."""
    variables = list(variables)
    for variable in variables:
        if variable.dtype is not str and not isinstance(variable.datatype, np.dtype):
            raise FileFault(f"holds values of a type of its own in {variable.name[:80]!r}", "save plain numbers")
    sizes = (math.prod(each.shape) * (TEXT if each.dtype is str else NUMBER) for each in variables)
    check_expansion(path, sum(sizes))


def _stored_attributes(holder: Any) -> dict[str, Any]:
    return {str(name): holder.getncattr(name) for name in holder.ncattrs()}


def append_to(file: Any, block: RecordBlock, compression: str = "none") -> None:
    """Append a block of pings to an open netCDF file; the first block defines its variables."""
    first = ALONG not in file.dimensions
    if first:
        _lay_out(file, block, compression)
    start = 0 if first else len(file.dimensions[ALONG])
    stop = start + block.sizes[ALONG]
    for name, variable in block.variables.items():
        if ALONG in variable.dims:
            place = tuple(slice(start, stop) if dim == ALONG else slice(None) for dim in variable.dims)
            file[name][place] = _stored(variable.values)
        elif first or name in TARGET_TRUTH:
            file[name][...] = _stored(variable.values)
    # Those of the whole record come with its last block.
    file.setncatts({key: _plain(value) for key, value in block.attributes.items() if key not in file.ncattrs()})


def _lay_out(file: Any, block: RecordBlock, compression: str) -> None:
    """Define dimensions, variables and attributes; only the dimension of pings is unlimited."""
    # Without compression, rows go to the file directly; a cache of chunks would only copy them once more.
    packed: dict[str, Any] = (
        {"chunk_cache": 1} if compression == "none" else {"compression": compression, "complevel": 1}
    )
    for name, size in block.sizes.items():
        file.createDimension(name, None if name == ALONG else size)
    for name, variable in block.variables.items():
        values = variable.values
        is_text = values.dtype.kind in "UOT"
        stored = str if is_text else _stored(values[..., :0] if values.ndim else values).dtype
        chunked = not is_text and ALONG in variable.dims
        layout = {"chunksizes": _chunks(variable), "fill_value": False, **packed} if chunked else {}
        made = file.createVariable(name, stored, variable.dims, **layout)
        made.setncatts(_attributes(block, name, variable))
    file.setncatts(CONVENTIONS)


def _chunks(variable: RecordVariable) -> list[int]:
    """Sizes of a variable's chunks: of one channel, equal parts of the first block of pings, a megabyte at most."""
    sizes = dict(zip(variable.dims, variable.values.shape))
    pings = max(sizes[ALONG], 1)
    sizes["channel"] = 1
    bytes_a_ping = variable.values.dtype.itemsize * math.prod(size for name, size in sizes.items() if name != ALONG)
    parts = math.ceil(pings * bytes_a_ping / CHUNK_BYTES)
    sizes[ALONG] = math.ceil(pings / max(parts, 1))
    return [max(sizes[name], 1) for name in variable.dims]


def _attributes(block: RecordBlock, name: str, variable: RecordVariable) -> dict[str, Any]:
    attributes, kind = {key: _plain(value) for key, value in variable.attributes.items()}, variable.values.dtype.kind
    if kind == "M":
        attributes |= {"units": EPOCH, "calendar": "proleptic_gregorian"}
    if kind == "b":
        attributes["dtype"] = "bool"
    # CF lists auxiliary coordinates in an attribute of the variables that have them.
    others = [
        one
        for one in block.coordinates
        if one not in block.sizes and set(block.variables[one].dims) <= set(variable.dims)
    ]
    if name not in block.coordinates and others:
        attributes["coordinates"] = " ".join(others)
    return attributes


def _stored(values: NDArray[Any]) -> NDArray[Any]:
    """Return values as netCDF stores them: times as integers, booleans as bytes, text as objects."""
    if values.dtype.kind == "M":
        return values.astype("datetime64[ns]").astype(np.int64)
    if values.dtype.kind == "b":
        return values.astype(np.int8)
    return values.astype(object) if values.dtype.kind in "UT" else values


def _plain(value: Any) -> Any:
    """Return an attribute as netCDF stores it: a number, an array or text."""
    return (
        value if isinstance(value, (int, float, np.number, np.ndarray)) and not isinstance(value, bool) else str(value)
    )


NETCDF = FileFormat(
    "netCDF",
    (".nc",),
    read_netcdf,
    write_netcdf,
    remedy="give a record written by insonify",
    labelled=True,
    of_blocks=True,
    options=(
        WriteOption("compression", ("none", "zlib"), "lossless compression of netCDF by cf"),
        WriteOption(
            "convention",
            ("cf", "sonar-netcdf4"),
            "convention of netCDF: climate and forecast, or that of ICES for sonars",
        ),
    ),
)
