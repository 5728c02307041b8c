"""Navigation in a record, as ``insonify render`` writes it."""

from __future__ import annotations

import numpy as np

from insonify.io.formats import FileFormat
from insonify.io.navigation.recorded import NAVIGATION, Columns, find_columns


def read_platform(path: str) -> Columns:
    """Read the columns of navigation in a netCDF record."""
    import netCDF4  # slow to import, and only recorded tracks need it

    try:
        with netCDF4.Dataset(path) as file:
            names = [str(name) for name in file.variables]
            values = {name: file.variables[names[place]][:] for name, place in find_columns(names).items()}
            return {
                name: np.ma.filled(np.ma.asarray(column, dtype=np.float64), np.nan).ravel()
                for name, column in values.items()
            }
    except (OSError, ValueError, TypeError) as error:
        raise NAVIGATION.refusal(
            path, f"cannot be read ({error})", "give a record as insonify render writes it"
        ) from None


RECORD = FileFormat("record in netCDF", (".nc",), read_platform)
