"""Navigation in a record, as ``insonify render`` writes it."""

from __future__ import annotations

import numpy as np

from insonify.io.formats import FileFormat
from insonify.io.isolation import run_isolated
from insonify.io.navigation.recorded import Columns, find_columns
from insonify.io.netcdf_files import check_variables


def read_platform(path: str) -> Columns:
    """Read the columns of navigation in a netCDF record."""
    return run_isolated(read_columns, path)


def read_columns(path: str) -> Columns:
    """Read the columns in this process, which the library may crash."""
    import netCDF4  # slow to import, and only recorded tracks need it

    with netCDF4.Dataset(path) as file:
        names = [str(name) for name in file.variables]
        found = {name: file.variables[names[place]] for name, place in find_columns(names).items()}
        check_variables(path, found.values())
        return {
            name: np.ma.filled(np.ma.asarray(column[:], dtype=np.float64), np.nan).ravel()
            for name, column in found.items()
        }


RECORD = FileFormat("record in netCDF", (".nc",), read_platform, remedy="give a record as insonify render writes it")
