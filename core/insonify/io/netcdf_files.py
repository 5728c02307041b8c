"""Variables of netCDF files, read in a process of its own."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from insonify.io.file_access import FileFault, check_expansion
from insonify.io.isolation import run_isolated
from insonify.io.record_block import RecordBlock, make_record_block

TEXT = 64  # bytes taken for a text of unknown length
NUMBER = 8  # bytes that a number may take after it is decoded


def read_stored(path: str) -> RecordBlock:
    """Read all variables of the root group of a netCDF file as they are stored: not scaled, without a mask."""
    return run_isolated(read_with_netcdf, path)


def read_with_netcdf(path: str) -> RecordBlock:
    """Read the variables in this process, which the library may crash."""
    import netCDF4  # slow to import

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        check_variables(path, file.variables.values())
        variables = {
            str(name): (each.dimensions, np.asarray(each[...]), _attributes(each))
            for name, each in file.variables.items()
        }
        return make_record_block(variables, {}, _attributes(file))


def check_variables(path: str, variables: Iterable[Any]) -> None:
    """Refuse variables that take too much memory, or hold other things than numbers and text."""
    variables = list(variables)
    for variable in variables:
        if variable.dtype is not str and not isinstance(variable.datatype, np.dtype):
            raise FileFault(f"holds values of a type of its own in {variable.name[:80]!r}", "save plain numbers")
    sizes = (math.prod(each.shape) * (TEXT if each.dtype is str else NUMBER) for each in variables)
    check_expansion(path, sum(sizes))


def _attributes(holder: Any) -> dict[str, Any]:
    return {str(name): holder.getncattr(name) for name in holder.ncattrs()}
