"""Records as NumPy archives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from insonify.io.atomic import replacing


def write_npz(path: str | Path, record: xr.Dataset) -> None:
    """Write a record as one array a variable; readable by ``numpy.load`` without pickles.

    An archive is written whole, so the record must fit in memory; a long tow belongs in netCDF.

    Parameters
    ----------
    path : str or Path
        File to make or replace; it appears only when whole.
    record : Dataset
        Variables and coordinates keep their names and shapes; attributes become ``attrs.<name>``.
    """
    arrays = {str(name): variable.values for name, variable in record.variables.items()}
    arrays |= {f"attrs.{key}": np.array(value) for key, value in record.attrs.items()}
    arrays = {name: values.astype(str) if values.dtype.kind in "OT" else values for name, values in arrays.items()}
    with replacing(path) as beside, beside.open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]
